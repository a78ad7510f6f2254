/* The least coasting times of one walk at one uncertainty level: what the units of this folder share.
 *
 * With a heading psi that only coasting changes, the end of the walk is
 *
 *     sum over stretches j of exp(i psi_j) (A_j + the straight coasts of the stretch),
 *
 * where each coast in a turn begins a new stretch. At a best point there is a multiplier m = exp(i alpha) / u
 * with Re(conj(m) v) = -1 for the end velocity v of every time that is not 0, and the end stands off the goal
 * by the tolerance in the direction of m. Seen from alpha, chi_j = psi_j - alpha:
 *
 *     Im(exp(i chi_j) A_j) = u a_j   with a_j = 1/r_j - 1/r_(j+1)   for a stretch without a straight coast,
 *     Re(exp(i chi_j) w) = -u        with w its velocity            for a stretch with one,
 *
 * so that every heading follows from the single number u (up to a sign each). The goal is one stretch more, which
 * closes the way: across alpha the stretches then add up to 0 of themselves, along alpha there is one equation,
 *
 *     sum over j of +-sqrt(|A_j|^2 - a_j^2 u^2) = tolerance,
 *
 * (a stretch with a straight coast adds another simple term). Its roots, over all sets of times that are not 0
 * and all signs, are all candidates; u = 0 is where the goal lies at the edge of reach.
 * As many times as equations need no u: they are intersections of lines and circles. docs/planner.md has the proof
 * that nothing else can be best.
 *
 * Every length and time is in units of the problem (units.c): the size of its displacements is about 1, and so is
 * the fastest speed. Tolerances without a unit are shares of these.
 */
#ifndef COASTING_H
#define COASTING_H

#include "../kernel.h"
#include <stdint.h>

#define LIMITLESS 1e100   /* u; a limit that is none */

typedef struct {                 /* times that are taken to be not 0 */
    int count, place[MOST + 1];  /* -1 after the last */
    int turns;                   /* turning ones among them */
    int bound_heading;           /* whether the heading at the end is at a limit */
    double target;               /* that limit */
    int shared;                  /* whether turns at one rate share a bound heading */
    double slowest;              /* rad/s; of those that turn at all */
    int slow;                    /* whether straight lines stand for slow turns */
    int blurred;                 /* whether turns are so slow that rounding of a heading is much of their time */
} ActiveSet;

typedef struct {                 /* a stretch whose heading is free */
    cplx A, w;
    double a, size, speed, limit;
    double above, K, aside;      /* stretches.c */
    double rate;                 /* of the turn that it begins with */
    int straight;                /* place in the walk of its straight coast; -1 without */
    int other;                   /* a second one; -1 without */
    cplx w_other;
} Stretch;

typedef struct {                 /* the stretches that a set of times makes */
    Problem *problem;
    const ActiveSet *on;
    int free;                    /* stretches with a free heading; after them the goal's, which closes the way */
    Stretch stretch[MOST + 2];
    int straights;               /* straight coasts */
    int fixed;                   /* those of them whose direction is fixed */
    int fixed_place[2];
    cplx fixed_velocity[2];
    cplx rest;                   /* goal less everything that is fixed */
    cplx last;                   /* factor of a fixed last heading */
    double last_rate;            /* of the turn that leads to it; 0 where the last heading is free */
    double most;                 /* largest u */
} Chain;

typedef struct {                 /* a point of a curve */
    double u;
    cplx alpha;                  /* exp(i alpha) */
    cplx chi[MOST + 2];          /* exp(i chi_j), times any length */
    double straight[MOST];
} Point;

/* A set of times that walks share. */
typedef struct {
    uint64_t mark[2];
    double coasting, inside;     /* s that it takes: with all times 0 or more, with all more than 0 */
    int numbers, unrefuted;      /* alike_sets.c: place of its numbers; how often a multiplier was sought in vain */
} KnownSet;

struct KnownSets {
    KnownSet *sets;
    long count, room;
    double way, speed, angle;    /* m, m/s, rad; what makes no difference */
    int once;
    long sought, refuted, passed; /* sets for which multipliers were sought, that these refuted, and passed by */
};

/* The numbers of a walk from which the marks of its sets of times are made. */
typedef struct {
    uint64_t coast[MOST][2];
    cplx before[MOST];           /* what the maneuvers before have displaced */
    uint64_t end[2];
} Marks;

/* What a problem in its own units was given as. */
typedef struct {
    const Problem *problem;
    double metre, second;        /* the units, in those of the problem given */
    const Help *help;
} Given;

/* motion.c: where times lead. */
cplx motion(const Problem *p, const double *times, cplx *velocity, double *turned);
int update_best(Problem *p, double *times);

/* newton.c: times corrected on the true motion. */
int solve_linear(double *M, double *b, int n);
void propose_headings(Problem *p, const ActiveSet *on, const cplx *heading, const double *straight, cplx m);

/* stretches.c: one stretch as a function of u. */
double across(const Chain *c, double s);
cplx add(const Stretch *s, double u, double root, Point *point, int j);
double E_of(const Stretch *one, double s);
double along(const Stretch *one, double E);
double slope_of(const Stretch *one, double E, double s);
double heading_of(const Stretch *one, double u, double E, int plus);
void set_headings(const Chain *c, Point *point);
void emit_times(const Chain *c, const double *signs, double s);
int turns_too_long(const Chain *c, const double *from, const double *to);

/* roots.c, curves.c: every root of the one equation. */
void isolate(const Chain *c, const double *signs, double low, double high, int halved);
void all_curves(Chain *c);

/* closed_forms.c: candidates that need no root. */
void in_line(Chain *c);
void determined(Chain *c);
void two_straights(Chain *c, int doubled);

/* bounds.c, dual_bound.c: sets of times that are not looked at. */
void choose(const Problem *p, ActiveSet *on, unsigned mask);
double least_time(const Problem *p, const ActiveSet *on, double distance);
double time_to_turn(const Problem *p, const ActiveSet *on);
double to_cover(const Problem *p);
int out_of_reach(const Problem *p, const ActiveSet *on, double seconds);
int refuted(const Problem *p, unsigned mask, int rounds, cplx *m);

/* known_sets.c, alike_sets.c: sets of times that other walks have, too. */
void set_marks(Marks *marks, const Problem *p, const KnownSets *known);
KnownSet *known_set(KnownSets *known, const Marks *marks, unsigned mask);
void exclude_alike(const Problem *p, unsigned useful, const Given *given, KnownSet **sets, char *out);

/* active_sets.c: every set of times. */
int straights_in(const Problem *p, unsigned mask);
void try_both_ways(Problem *p, ActiveSet *on, unsigned mask);
void solve_in_units(Problem *p, int most, const Given *given);

#endif
