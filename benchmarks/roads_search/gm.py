import sys; sys.path[:0]=['/work/wt/roads/benchmarks']
import numpy as np, time
import rough_truth as rt
from elastomdr.rough import half_space as hs
from scipy.sparse.linalg import gmres, bicgstab, LinearOperator
from elastomdr.surface.spectrum import rough_map
count=[0]
def gm(A,b,rtol,atol,maxiter,M,callback):
    n=[0]
    def AM(y):
        n[0]+=1; return A.matvec(M.matvec(y.astype(b.dtype)))
    op=LinearOperator(A.shape,matvec=AM,dtype=b.dtype)
    y,info=gmres(op,b,rtol=0.0,atol=atol,restart=80,maxiter=3)
    count[0]=n[0]
    return M.matvec(y.astype(b.dtype)),info
def run(i,use,cut=1,seed=3):
    rng=np.random.default_rng([1,i]); s=rt.draw(rng,1024)
    kind,*num=s['surface']; sp=rt.surface_of(kind,tuple(num),s['ratio']); m=rt.rubber(s['material']).complex_modulus
    n=4*-(-s['per_wave']*s['periods']*s['ratio']//4)
    h,side=rough_map(sp,seed,periods=s['periods'],points=n)
    if cut==2: h=h[::2,::2]
    hs.bicgstab=use
    orig=hs._solved
    tot=[0]
    def spy(*a):
        r=orig(*a)
        if use is gm: r=(r[0],r[1],count[0]+1)
        tot[0]+=r[2] if a[1].shape==h.shape else 0
        return r
    hs._solved=spy
    t=time.process_time()
    f=hs.solve(m,h,(side,side),velocity=s['velocity'],pressure=s['pressure'],double=False)
    hs._solved=orig
    print(i,s['material'],h.shape,use.__name__,f.area,f.stress,f.settled,'finest products',tot[0],f'{time.process_time()-t:.2f}s',flush=True)
for i in (10,5,4):
    for use in (bicgstab,gm): run(i,use,2)
