/* The search over walks: what the units of this folder share. */
#ifndef WALKS_H
#define WALKS_H

#include "../kernel.h"
#include <stdlib.h>

/* Trims and maneuvers have places, not ids; numbers are laid out level after level. */
typedef struct {
    const int *first;            /* the first maneuver that leaves each trim, and one past the last of all */
    const int *to;               /* trim that each maneuver leads to */
    const double *rate, *speed, *turn, *duration, *size; /* size: of the displacement */
    const cplx *velocity, *displacement;
    int trims, levels;
} Automaton;

typedef struct {
    double goal_north, goal_east, tolerance, slack, heading, heading_tolerance, heading_slack, seconds;
    long wants_heading, start_trim, goal_trim, max_trims, most_nodes;
} Task;

/* A walk, or all walks that begin with it: at each trim the place of the next maneuver among those that leave. */
typedef struct {
    double bound;                /* s; of the walk, or of all those walks */
    unsigned short step[MOST - 1];
    unsigned char trims, closed; /* closed: the walk alone */
} Entry;

/* The trims and maneuvers of a walk, as places in the automaton. */
typedef struct { int length, trim[MOST], maneuver[MOST]; } Walk;

/* A walk at one level. The problem points into it: it stays where it is. */
typedef struct {
    Problem problem;
    double rate[MOST], speed[MOST], size_D[MOST], bearing_D[MOST], bearing_W[MOST], turned[MOST];
    cplx W[MOST], C[MOST], D[MOST];
} WalkProblem;

#define SPEEDS 10         /* at most; more are put together with the next faster ones */

/* Least seconds of all continuations (remaining.c). */
typedef struct {
    int speeds[MOST];            /* of each level */
    double slowness[MOST][SPEEDS]; /* s/m; descending */
    int *group;                  /* of the speed of each trim at each level */
    double *least;               /* s; level, speed (one more: seconds alone), trims left, trim */
    int trims, depth;
} Remaining;

/* What walks with a common beginning share at one level. */
typedef struct { double fixed, distance; int group; } Beginning;

typedef struct { Entry *entries; long count, room, most; } Frontier;

typedef struct {
    double cost, bound, times[MOST * MOST], costs[MOST];
    long trims, walk[MOST], nodes, complete;
} Answer;

typedef struct {
    const Task *task;
    const Automaton *automaton;
    Answer *answer;
    cplx multiplier[MOST];       /* s/m; at each level, one that was good for the walk before */
    Remaining remaining;
    Walk best;
    Frontier frontier;
    Frontier left;               /* walks that were looked at and not excluded */
    Frontier ways, stack;        /* ways on from one walk; what waits to be followed depth first */
    double way, fastest;         /* m, m/s; the sizes of things */
    int telling;                 /* level that decided the best walk; without one, that excluded the walk before */
    long looked, better, found;  /* walks that were looked at, the last that became the best; ways on that were found */
    long bounded, excluded, passed; /* walks that were bounded, that this excluded, and passed by */
    Help quick, whole;           /* for times of a walk: with as many as equations only, tried once; with all */
} Search;

/* One walk at every level, in the order in which they are looked at: the one with the largest bound first. */
typedef struct { Walk walk; WalkProblem level[MOST]; int order[MOST]; } Levels;

static inline long smaller(long a, long b) { return a < b ? a : b; }
static inline long larger(long a, long b) { return a > b ? a : b; }

/* automaton.c: walks as problems. */
void read_walk(const Automaton *a, const Task *task, const Entry *entry, Walk *walk);
cplx first_multiplier(cplx goal);
void set_task(Problem *p, const Task *task);
void set_sizes(WalkProblem *one, const Automaton *a, const Task *task, const Walk *walk, int level);
void set_vectors(WalkProblem *one, const Automaton *a, const Walk *walk, int level);

/* remaining.c: bounds of the continuations of a walk. */
int make_remaining(Remaining *r, const Automaton *a, const Task *task);
void free_remaining(Remaining *r);
double least_seconds(const Remaining *r, int level, const Beginning *begun, int trim, int left);

/* frontier.c: a priority queue of walks and beginnings. */
int in_order(const void *one, const void *other);
int has_room(Frontier *f, long more);
void append(Frontier *f, const Entry *entry);
void push(Frontier *f, const Entry *entry);
Entry pop(Frontier *f);

/* ways.c: the ways on from the beginning of a walk. */
int make_room(Search *s);
void free_room(Search *s);
double bound_of_all(const Search *s);
void find_ways(Search *s, const Entry *entry, int fewest, int most);

/* levels.c: one walk at every level. */
int excluded(Search *s, const Entry *entry, Levels *every);
int solved(Search *s, const Levels *every, int most);
void polish(Search *s);

#endif
