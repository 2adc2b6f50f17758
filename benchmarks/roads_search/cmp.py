import sys
def load(p):
    d={}
    for l in open(p):
        a=l.rstrip().split(" ")
        d[l[:l.find("0x")].rsplit(" ",2)[0] if "0x" in l else l.rstrip()]=l.rstrip()
    return d
a,b=open(sys.argv[1]).read().splitlines(),open(sys.argv[2]).read().splitlines()
if len(a)!=len(b): print("LENGTHS",len(a),len(b))
worst={}
for x,y in zip(a,b):
    if x==y: continue
    xs=[float.fromhex(t) for t in x.split() if t.startswith(("0x","-0x"))]
    ys=[float.fromhex(t) for t in y.split() if t.startswith(("0x","-0x"))]
    if not xs: print("DIFF",x[:150],"|",y[:150]); continue
    s=max(map(abs,xs)) or 1
    d=max((abs(p-q) for p,q in zip(xs,ys)),default=0)/s
    print("moved",x.split("0x")[0][:60],f"{d:.1e}")
