#pragma once
#include <cstdlib>
namespace shapelight::tune {
inline double env(const char* n, double d) { const char* s = std::getenv(n); return s ? std::atof(s) : d; }
#define TUNE(name, value) inline const double name = env(#name, value);
TUNE(N_THIN, 4000)
TUNE(RADIUS, 5)      // spacings
TUNE(SOFT, 1)
TUNE(HELL, 1)
TUNE(WPOW, 1)
TUNE(KEYS, 800)
TUNE(KBEST, 2)
TUNE(MAXM, 2500)
TUNE(TOL, 1.5)       // spacings
TUNE(NCOS, 0.35)
TUNE(SEEDS, 200)
TUNE(KSEED, 20)
TUNE(VERIFY, 1)
TUNE(REFINE, 40)
TUNE(VTOL, 1.5)
TUNE(VCOS, 0.7)
}
