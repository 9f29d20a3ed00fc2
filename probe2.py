import warnings; warnings.simplefilter("ignore")
import numpy as np, time, sys, signal
from benchmarks.scan.families import motion
from softcradle.physics.methods import refusal_of
from softcradle.physics.simulation import solve
from tests.helpers.relations import *
class TO(Exception): pass
def h(*a): raise TO
signal.signal(signal.SIGALRM,h)
for fam in ("timed","driven","friction","loss","couplers","bounded","walls","own-laws","clusters"):
  for seed in range(10):
    m=motion(fam,seed); g=(m.chain,m.velocity,m.duration); t0=time.time()
    signal.alarm(6)
    try:
        truth=solve(*g,"scipy",tolerance=1e-9,samples=5)
        T=truth.time[-1]; t1=time.time()-t0
        out=[]
        for me in KERNELS:
            if refusal_of(me,m.chain): continue
            f=solve(*g[:2],T,me,tolerance=1e-7,samples=5)
            out.append("%s %.0e/%.0e ov %.0e led %.0e w%d"%(me[0],np.abs(f.velocity-truth.velocity).max()/m.speed,f.velocity_error.max()/m.speed,np.abs(f.overlap-truth.overlap).max(),ledger_error(f),len(f.warnings)))
        f=solve(*g[:2],T,"conserving",T/20000,samples=5)
        out.append("cons %.0e led %.0e"%(np.abs(f.velocity-truth.velocity).max()/m.speed,ledger_error(f)))
        signal.alarm(0)
        print(fam,seed,"%.1fs all %.1fs"%(t1,time.time()-t0),*out, "scipy %.0e"%ledger_error(truth),flush=True)
    except TO: print(fam,seed,"slow",flush=True)
    except Exception as e: signal.alarm(0); print(fam,seed,e,flush=True)
