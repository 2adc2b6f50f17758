"""merge.py TARGET SOURCE...: appends the body of each source to the target, imports on top, module constants after imports."""
import ast,sys,re,subprocess,os
os.chdir('/work/wt/transient/src/elastomdr/transient')
def parts(p):
    s=open(p).read(); t=ast.parse(s); lines=s.splitlines(keepends=True)
    body=t.body; doc=''
    k=0
    if isinstance(body[0],ast.Expr): doc=''.join(lines[:body[0].end_lineno]); k=1
    imps=[];typing=[];rest_start=None
    for n in body[k:]:
        if isinstance(n,(ast.Import,ast.ImportFrom)):
            src=''.join(lines[n.lineno-1:n.end_lineno]); imps.append(src)
        elif isinstance(n,ast.If) and getattr(n.test,'id','')=='TYPE_CHECKING':
            typing.append(''.join(lines[n.body[0].lineno-1:n.end_lineno]))
        else:
            rest_start=n; break
    start=rest_start.lineno-1
    if getattr(rest_start,'decorator_list',None): start=rest_start.decorator_list[0].lineno-1
    while start>0 and lines[start-1].startswith('#'): start-=1
    return doc,imps,typing,''.join(lines[start:])
def consts(body):
    # leading block of constants until first def/class/decorator
    m=re.search(r'^(@|def |class )',body,re.M)
    # include comments directly above
    head=body[:m.start()]; return head,body[m.start():]
tgt=sys.argv[1]
doc,imps,typing,body=parts(tgt)
chead,cbody=consts(body)
for s in sys.argv[2:]:
    d,i,t,b=parts(s); imps+=i; typing+=t
    h,c=consts(b); chead=chead.rstrip()+"\n"+h; cbody=cbody.rstrip()+"\n\n\n"+c
    print("DOC of",s,":\n",d)
names=[x[:-3] for x in sys.argv[1:]]
imps=[i for i in imps if not any(re.match(rf'from \.{n} import',i) for n in names)]
fut=[i for i in imps if '__future__' in i]; imps=[i for i in imps if '__future__' not in i]
typing=[re.sub('','',t) for t in typing]
ty='' 
if typing:
    ty='if TYPE_CHECKING:\n'+''.join(typing)
    for n in names: ty=re.sub(rf'    from \.{n} import.*\n','',ty)
open(tgt,'w').write(doc+"\n"+(fut[0] if fut else '')+"\n"+''.join(imps)+"\n"+ty+"\n"+chead.strip()+"\n\n\n"+cbody)
for s in sys.argv[2:]:
    subprocess.run(['git','rm','-qf','--cached',s]); os.remove(s)
subprocess.run(['ruff','check','-q','--fix','--select','I,F401,F811',tgt]); subprocess.run(['ruff','format','-q',tgt])
subprocess.run('ruff check --output-format concise '+tgt,shell=True)
