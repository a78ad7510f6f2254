/* Shared declarations of the exact search. */
#ifndef KERNEL_H
#define KERNEL_H

#include <complex.h>
#include <math.h>
#include <string.h>
#include <time.h>

#define PUBLIC __attribute__((visibility("default"))) /* called from Python */

#define MOST 12           /* trims in a walk; uncertainty levels */
#define PI 3.14159265358979323846

/* Capacities, and sample sizes before the search adapts. Tests build with small ones (-DLITTLE). */
#ifdef LITTLE
enum {
    MOST_QUEUED = 40, MOST_DEFERRED = 20, MANY_WALKS = 2, PATIENCE = 5, MIN_TRIALS = 10, RARE_SUCCESS = 2,
    SETS_TO_LEARN = 20
};
#else
enum {
    MOST_QUEUED = 1500000,       /* nodes in the queue, 48 MB; beyond, the search goes depth first */
    MOST_DEFERRED = 1000000,     /* walks deferred to the second pass, 32 MB; beyond, each is solved at once */
    MANY_WALKS = 256,            /* walks from which on results of some are kept for others */
    PATIENCE = 1000,             /* walks without an improvement after which the first pass only bounds */
    MIN_TRIALS = 1000,           /* bounds computed before their success rate is judged */
    RARE_SUCCESS = 20,           /* a bound that prunes less often than once in so many is computed once in so many */
    SETS_TO_LEARN = 2000,        /* active sets after which the radius of clusters is judged */
};
#endif

typedef double complex cplx;

/* A walk at one uncertainty level, and its goal. Positions are complex (north + i east), in the frame of the start.
 * Headings are those made by coasting alone: W, C and D are rotated by the heading changes of the maneuvers before. */
typedef struct {
    int trims;
    const double *rate;          /* rad/s */
    const cplx *W, *C, *D;       /* velocity, centre of the turn, displacement of the maneuver before */
    const double *bearing_D, *bearing_W, *size_D, *speed;  /* D and W, polar */
    double fixed;                /* s in maneuvers */
    cplx goal;
    double tolerance;            /* m */
    double slack;                /* m; allowed on top for rounding */
    int wants_heading;
    double heading;              /* rad, to be turned by coasting, modulo full turns */
    double heading_tolerance, heading_slack;
    double best;                 /* s; the incumbent: only faster times are kept */
    cplx multiplier;             /* s/m; starting value for bounds */
    double straight, hardly_bent; /* rad/s; slower turns are straight lines, or solved both ways */
    double times[MOST];
} Problem;

/* Of a number and a not-a-number both return the latter. */
static inline double lesser(double a, double b) { return a < b ? a : b; }
static inline double greater(double a, double b) { return a > b ? a : b; }

static inline double cross(cplx one, cplx two) { return creal(one) * cimag(two) - cimag(one) * creal(two); }
static inline double dot(cplx one, cplx two) { return creal(one) * creal(two) + cimag(one) * cimag(two); }
static inline double length(cplx z) { return sqrt(dot(z, z)); }
static inline cplx unit_complex(double angle) { return cos(angle) + I * sin(angle); }

/* For numbers below 2^51. */
static inline double round_to_integer(double value) { return (value + 0x1.8p52) - 0x1.8p52; }
static inline double off_turns(double angle) { return angle - 2 * PI * round_to_integer(angle / (2 * PI)); }

/* Distance from the goal that counts as reached, m. */
static inline double reach(const Problem *p) { return p->tolerance + p->slack; }

static inline double clock_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static inline int past_deadline(double deadline) { return deadline < INFINITY && clock_now() >= deadline; }

/* Lower bounds of active sets, shared by walks (coasting/set_cache.c, similar_sets.c). */
typedef struct SetCache SetCache;
typedef struct SimilarSets SimilarSets;
SetCache *make_set_cache(long capacity, double share, double length, double speed, int once);
void free_set_cache(SetCache *cache);
SimilarSets *make_similar_sets(double length, double speed);
void free_similar_sets(SimilarSets *similar);

/* Caches, or none, and the time at which to stop. */
typedef struct { SetCache *cache; SimilarSets *similar; double deadline; } SolveContext;

/* coasting/units.c: solver and bounds of one walk at one level. */
void solve(Problem *p, int most);
void solve_with(Problem *p, int most, const SolveContext *context);
double lower_bound(const Problem *p);
int cannot_beat(Problem *p);

#endif
