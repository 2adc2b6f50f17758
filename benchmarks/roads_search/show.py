import sys
a,b=[{tuple(l.split(" 0x")[0].split(" -0x")[0].split()[:-1]):[float.fromhex(t) for t in l.split() if t.startswith(("0x","-0x"))] for l in open(p) if "0x" in l} for p in sys.argv[1:3]]
for k in b:
    if all(x in k for x in sys.argv[3:]): print(k); print("  ",a.get(k)); print("  ",b[k])
