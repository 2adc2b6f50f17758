import ast,pathlib,sys
for p in sorted(pathlib.Path('/work/wt/transient/src/elastomdr/transient').glob('*.py')):
    t=ast.parse(p.read_text())
    for f in ast.walk(t):
        if isinstance(f,ast.FunctionDef):
            L=f.end_lineno-f.lineno+1
            if ast.get_docstring(f): d=f.body[0]; L-=d.end_lineno-d.lineno+1
            if L>50: print(p.name,f.name,L)
