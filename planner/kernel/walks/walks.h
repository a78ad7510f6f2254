/* Shared declarations of the search over walks. */
#ifndef WALKS_H
#define WALKS_H

#include "../kernel.h"
#include <stdlib.h>

/* The maneuver automaton: trims and maneuvers by index, their values level after level. */
typedef struct {
    const int *first;            /* index of the first maneuver that leaves each trim; one more entry at the end */
    const int *to;               /* trim that each maneuver leads to */
    const double *rate, *speed, *turn, *duration, *size; /* size: of the displacement */
    const cplx *velocity, *displacement;
    int trims, levels;
} Automaton;

typedef struct {
    double goal_north, goal_east, tolerance, slack, heading, heading_tolerance, heading_slack, seconds;
    long wants_heading, start_trim, goal_trim, max_trims, most_nodes;
} Task;

/* A node of the search tree: all walks with a common prefix, or, as a leaf, the prefix itself. A step is the index of a
 * maneuver among those that leave its trim. */
typedef struct {
    double bound;                /* s; lower bound of the node */
    unsigned short step[MOST - 1];
    unsigned char trims, leaf;
} Node;

/* A walk by indices into the automaton. */
typedef struct { int length, trim[MOST], maneuver[MOST]; } Walk;

/* A walk at one level, with the arrays that its problem points to; not to be moved. */
typedef struct {
    Problem problem;
    double rate[MOST], speed[MOST], size_D[MOST], bearing_D[MOST], bearing_W[MOST], turned[MOST];
    cplx W[MOST], C[MOST], D[MOST];
} WalkProblem;

#define SPEEDS 10         /* most groups of trims by speed; a group has the speed of its fastest trim */

/* Lower bounds of the continuations of a walk (remaining.c). */
typedef struct {
    int speeds[MOST];            /* groups at each level */
    double slowness[MOST][SPEEDS]; /* s/m; descending */
    int *group;                  /* of each trim at each level */
    double *least;               /* s; by level, group (one more: maneuvers alone), trims left, trim */
    int trims, depth;
} Remaining;

/* A walk's prefix at one level: seconds of its maneuvers, distance that they leave, group of its fastest trim. */
typedef struct { double fixed, distance; int group; } Prefix;

typedef struct { Node *entries; long count, capacity, most; } Frontier;

typedef struct {
    double cost, bound, times[MOST * MOST], costs[MOST];
    long trims, walk[MOST], nodes, complete;
} Answer;

typedef struct {
    const Task *task;
    const Automaton *automaton;
    Answer *answer;              /* the incumbent */
    cplx multiplier[MOST];       /* s/m; by level, starting values for the next walk's bounds */
    Remaining remaining;
    Walk best;
    Frontier frontier;           /* the priority queue of the best-first search */
    Frontier deferred;           /* walks left to the second pass */
    Frontier branches, stack;    /* children of one node; nodes of the depth-first search */
    double length_scale, speed_scale; /* m, m/s */
    int deciding_level;          /* of the incumbent; without one, the level at which the last walk was infeasible */
    long examined, improved_at, branched; /* walks, the number of the last that improved; children */
    long bounded, pruned, skipped; /* walks: bounded by multipliers, pruned by them, left out */
    SolveContext first_pass, second_pass; /* closed forms only; all active sets */
} Search;

/* A walk at every level, and the order in which levels are solved: by decreasing lower bound. */
typedef struct { Walk walk; WalkProblem level[MOST]; int order[MOST]; } Levels;

static inline long smaller(long a, long b) { return a < b ? a : b; }
static inline long larger(long a, long b) { return a > b ? a : b; }

/* automaton.c: problems of a walk. */
void read_walk(const Automaton *a, const Task *task, const Node *entry, Walk *walk);
cplx first_multiplier(cplx goal);
void set_task(Problem *p, const Task *task);
void set_sizes(WalkProblem *one, const Automaton *a, const Task *task, const Walk *walk, int level);
void set_vectors(WalkProblem *one, const Automaton *a, const Walk *walk, int level);

/* remaining.c: bounds of the continuations of a walk. */
int make_remaining(Remaining *r, const Automaton *a, const Task *task);
void free_remaining(Remaining *r);
double least_seconds(const Remaining *r, int level, const Prefix *prefix, int trim, int left);

/* frontier.c: a priority queue of nodes. */
int in_order(const void *one, const void *other);
int reserve(Frontier *f, long more);
void append(Frontier *f, const Node *entry);
void push(Frontier *f, const Node *entry);
Node pop(Frontier *f);

/* branching.c: children of a node. */
int allocate(Search *s);
void release(Search *s);
double root_bound(const Search *s);
void branch(Search *s, const Node *entry, int fewest, int most);

/* levels.c: pruning and solution of one walk at every level. */
int pruned_by_bounds(Search *s, const Node *entry, Levels *every);
int improves_incumbent(Search *s, const Levels *every, int most);
void polish(Search *s);

#endif
