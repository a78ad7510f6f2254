/* The kernel of the exact search: what its units share, and what is public. */
#ifndef KERNEL_H
#define KERNEL_H

#include <complex.h>
#include <math.h>
#include <string.h>
#include <time.h>

#define PUBLIC __attribute__((visibility("default"))) /* called from Python; everything else is hidden */

#define MOST 12           /* trims in a walk, and uncertainty levels */
#define PI 3.14159265358979323846

/* What there is room for, and from when on something is learnt. Tests build with little of it (-DLITTLE). */
#ifdef LITTLE
enum { MOST_WAITING = 40, MOST_LEFT = 20, MANY = 2, PATIENCE = 5, TRIALS = 10, RARELY = 2, LEARNING = 20 };
#else
enum {
    MOST_WAITING = 1500000,      /* walks and beginnings that wait, 48 MB; beyond, they come depth first */
    MOST_LEFT = 1000000,         /* walks that were looked at, 32 MB; beyond, each is solved at once */
    MANY = 256,                  /* walks; from so many on, what is known of some is worth knowing for others */
    PATIENCE = 1000,             /* walks in vain, or as many as before; then they are left for later without a try */
    TRIALS = 1000,               /* bounds that are computed before it is said that they rarely exclude, ... */
    RARELY = 20,                 /* ... which is one of so many; then so many are passed by for each that is computed */
    LEARNING = 2000,             /* sets of times; then it is looked at how near those that are alike are */
};
#endif

typedef double complex cplx;

/* A walk at one uncertainty level, and where it is to end. Positions are complex (north + i east), seen from the start
 * with heading 0. Headings are those that coasting alone makes: what the maneuvers before have turned is folded into
 * W, C and D. */
typedef struct {
    int trims;
    const double *rate;          /* rad/s */
    const cplx *W, *C, *D;       /* velocity, centre of the turn, displacement of the maneuver before */
    const double *bearing_D, *bearing_W, *size_D, *speed;  /* D and W, polar */
    double fixed;                /* s in maneuvers */
    cplx goal;
    double tolerance;            /* m; candidates use all of it ... */
    double slack;                /* m; ... and may be off by that much more through rounding */
    int wants_heading;
    double heading;              /* what coasting has to turn, rad, modulo full turns */
    double heading_tolerance, heading_slack;
    double best;                 /* s; only faster ones are kept */
    cplx multiplier;             /* s/m; near that of the best times */
    double straight, hardly_bent; /* rad/s; slower turns are taken as straight lines, or in both ways */
    double times[MOST];
} Problem;

/* Of a number and a not-a-number they return the latter. */
static inline double lesser(double a, double b) { return a < b ? a : b; }
static inline double greater(double a, double b) { return a > b ? a : b; }

static inline double cross(cplx one, cplx two) { return creal(one) * cimag(two) - cimag(one) * creal(two); }
static inline double dot(cplx one, cplx two) { return creal(one) * creal(two) + cimag(one) * cimag(two); }
static inline double length(cplx z) { return sqrt(dot(z, z)); }
static inline cplx unit_complex(double angle) { return cos(angle) + I * sin(angle); }

/* For numbers below 2^51. */
static inline double round_to_integer(double value) { return (value + 0x1.8p52) - 0x1.8p52; }
static inline double off_turns(double angle) { return angle - 2 * PI * round_to_integer(angle / (2 * PI)); }

/* What counts as reached, in metres from the goal. */
static inline double reach(const Problem *p) { return p->tolerance + p->slack; }

static inline double clock_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static inline int late(double until) { return until < INFINITY && clock_now() >= until; }

/* What is known of sets of times that other walks have, too (coasting/known_sets.c, alike_sets.c). */
typedef struct KnownSets KnownSets;
typedef struct AlikeSets AlikeSets;
KnownSets *make_known_sets(long room, double share, double way, double speed, int once);
void free_known_sets(KnownSets *known);
AlikeSets *make_alike_sets(double way, double speed);
void free_alike_sets(AlikeSets *alike);

/* With what a walk is solved: what is known of others, or nothing, and until when. */
typedef struct { KnownSets *known; AlikeSets *alike; double until; } Help;

/* coasting/units.c: what searches call. */
void solve(Problem *p, int most);
void solve_with(Problem *p, int most, const Help *help);
double lower_bound(const Problem *p);
int cannot_beat(Problem *p);

#endif
