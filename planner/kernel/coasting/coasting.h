/* Shared declarations of the solver for one walk at one uncertainty level.
 *
 * With a heading psi changed only by coasting, the end of the walk is
 *
 *     sum over stretches j of exp(i psi_j) (A_j + the straight coasts of the stretch),
 *
 * where each turning coast begins a new stretch. At an optimum there is a multiplier m = exp(i alpha) / u with
 * Re(conj(m) v) = -1 for the end velocity v of every nonzero time (the time is stationary), and the end is off the goal
 * by the tolerance in the direction of m. Seen from alpha, with chi_j = psi_j - alpha:
 *
 *     Im(exp(i chi_j) A_j) = u a_j   with a_j = 1/r_j - 1/r_(j+1)   for a stretch without a straight coast,
 *     Re(exp(i chi_j) w) = -u        with w its velocity            for a stretch with one,
 *
 * so that all headings follow from the single number u, up to a sign each. The goal closes the chain like one more
 * stretch. Across alpha the contributions of all stretches then sum to 0, and along alpha there is one equation,
 *
 *     sum over j of +-sqrt(|A_j|^2 - a_j^2 u^2) = tolerance
 *
 * (a stretch with a straight coast adds another simple term). Its roots, over all active sets and all signs, are the
 * candidates; at u = 0 the goal lies at the edge of reach. With as many times as equations no u is needed: candidates
 * are intersections of lines and circles. docs/planner.md proves that no other candidate exists.
 *
 * All quantities are scaled (units.c): displacements and the fastest speed are about 1. Tolerances without a unit are
 * relative.
 */
#ifndef COASTING_H
#define COASTING_H

#include "../kernel.h"
#include <stdint.h>

#define LIMITLESS 1e100   /* u; no limit */

typedef struct {                 /* the nonzero times of a candidate */
    int count, place[MOST + 1];  /* index of each in the walk; -1 after the last */
    int turns;                   /* those in a turn */
    int bound_heading;           /* whether the final heading is at a limit of its tolerance */
    double target;               /* that limit */
    int shared;                  /* whether all are turns at one rate with the final heading bound */
    double slowest;              /* rad/s; of those that are not 0 */
    int slow;                    /* whether slow turns are taken as straight lines */
    int blurred;                 /* whether turns are so slow that the rounding of a heading blurs their times */
} ActiveSet;

typedef struct {                 /* a stretch of free heading */
    cplx A, w;
    double a, size, speed, limit;
    double above, K, aside;      /* stretches.c */
    double rate;                 /* rad/s; of the turn at its beginning */
    int straight;                /* index of its straight coast in the walk; -1 without */
    int other;                   /* index of a second one; -1 without */
    cplx w_other;
} Stretch;

typedef struct {                 /* the stretches of a walk for an active set */
    Problem *problem;
    const ActiveSet *on;
    int free;                    /* stretches of free heading; the goal's follows and closes the chain */
    Stretch stretch[MOST + 2];
    int straights;               /* straight coasts */
    int fixed;                   /* those of fixed direction */
    int fixed_place[2];
    cplx fixed_velocity[2];
    cplx rest;                   /* goal less the fixed displacements */
    cplx last;                   /* exp(i psi) of a fixed final heading */
    double last_rate;            /* rad/s; of the turn to it; 0 with a free final heading */
    double most;                 /* largest u */
} Chain;

typedef struct {                 /* a point of a curve */
    double u;
    cplx alpha;                  /* exp(i alpha) */
    cplx chi[MOST + 2];          /* exp(i chi_j), times any length */
    double straight[MOST];
} Point;

/* An active set found in several walks, with lower bounds of its coasting seconds. */
typedef struct {
    uint64_t hash[2];
    double bound, interior_bound; /* s; with times of at least 0, and with all of them above 0 */
    int coefficients, failed_climbs; /* similar_sets.c: where they stand; how often no multiplier was found */
} CachedSet;

struct SetCache {
    CachedSet *sets;
    long count, capacity;
    double length_step, speed_step, angle_step; /* m, m/s, rad; coefficients are rounded to these */
    int once;
    long climbs, prunings, skipped; /* ascents of multipliers: made, successful, left out */
};

/* The parts of a walk that the hashes of its active sets are made from. */
typedef struct {
    uint64_t coast[MOST][2];
    cplx before[MOST];           /* displacement of the maneuvers up to each trim */
    uint64_t end[2];
} WalkHash;

/* A scaled problem's original, and the units in which it is scaled. */
typedef struct {
    const Problem *problem;
    double metre, second;
    const SolveContext *context;
} Unscaled;

/* motion.c: end of a walk, and the incumbent. */
cplx motion(const Problem *p, const double *times, cplx *velocity, double *turned);
int update_best(Problem *p, double *times);

/* newton.c: correction of candidates on the true motion. */
int solve_linear(double *M, double *b, int n);
void propose_headings(Problem *p, const ActiveSet *on, const cplx *heading, const double *straight, cplx m);

/* stretches.c: a stretch's contribution and heading. */
double across(const Chain *c, double s);
cplx add(const Stretch *s, double u, double root, Point *point, int j);
double E_of(const Stretch *one, double s);
double along(const Stretch *one, double E);
double slope_of(const Stretch *one, double E, double s);
double heading_of(const Stretch *one, double u, double E, int plus);
void set_headings(const Chain *c, Point *point);
void emit_times(const Chain *c, const double *signs, double s);
int turns_too_long(const Chain *c, const double *from, const double *to);

/* roots.c, curves.c: roots of the one equation. */
void isolate(const Chain *c, const double *signs, double low, double high, int halved);
void all_curves(Chain *c);

/* closed_forms.c: candidates without a root. */
void in_line(Chain *c);
void determined(Chain *c);
void two_straights(Chain *c, int doubled);

/* bounds.c, dual_bound.c: lower bounds of active sets. */
void choose(const Problem *p, ActiveSet *on, unsigned mask);
double least_time(const Problem *p, const ActiveSet *on, double distance);
double time_to_turn(const Problem *p, const ActiveSet *on);
double to_cover(const Problem *p);
int out_of_reach(const Problem *p, const ActiveSet *on, double seconds);
int refuted(const Problem *p, unsigned mask, int rounds, cplx *m);

/* set_cache.c, similar_sets.c: results shared by walks. */
void hash_walk(WalkHash *walk_hash, const Problem *p, const SetCache *known);
CachedSet *cached_set(SetCache *known, const WalkHash *walk_hash, unsigned mask);
void exclude_similar(const Problem *p, unsigned useful, const Unscaled *unscaled, CachedSet **sets, char *out);

/* active_sets.c, enumeration.c. */
int straights_in(const Problem *p, unsigned mask);
void try_both_ways(Problem *p, ActiveSet *on, unsigned mask);
void solve_in_units(Problem *p, int most, const Unscaled *unscaled);

#endif
