/* The maneuver automaton at every level, and walks in it. */
#include "solve.c"

/* Trims and maneuvers have places, not ids; numbers are laid out level after level. */
typedef struct {
    const int *first;            /* the first maneuver that leaves each trim, and one past the last of all */
    const int *to;               /* trim that each maneuver leads to */
    const double *rate, *speed, *turn, *duration, *size; /* size: of the displacement */
    const cplx *velocity, *displacement;
    int trims, levels;
} Automaton;

typedef struct {
    double goal_north, goal_east, tolerance, heading, heading_tolerance, seconds;
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

/* A walk at one level. The row points into it: it stays where it is. */
typedef struct {
    Row row;
    double rate[MOST], speed[MOST], size_D[MOST], bearing_D[MOST], bearing_W[MOST], turned[MOST];
    cplx W[MOST], C[MOST], D[MOST];
} WalkRow;

static void read_walk(const Automaton *a, const Task *task, const Entry *entry, Walk *walk)
{
    walk->length = entry->trims;
    walk->trim[0] = (int)task->start_trim;
    for (int k = 1; k < entry->trims; k++) {
        walk->maneuver[k] = a->first[walk->trim[k - 1]] + entry->step[k - 1];
        walk->trim[k] = a->to[walk->maneuver[k]];
    }
}

/* Against the goal, at 5 m/s. */
static cplx first_worth(cplx goal) { return cabs(goal) > 0 ? -0.2 * goal / cabs(goal) : -0.2; }

static void set_task(Row *row, const Task *task)
{
    row->goal = task->goal_north + I * task->goal_east;
    row->tolerance = task->tolerance;
    row->wants_heading = (int)task->wants_heading;
    row->heading_tolerance = task->heading_tolerance;
    row->straight = row->hardly_bent = 0;
}

/* What cheap bounds need: speeds, rates, sizes, and what the maneuvers turn in all. */
static void set_sizes(WalkRow *one, const Automaton *a, const Task *task, const Walk *walk, int level)
{
    int maneuvers = a->first[a->trims];
    Row *row = &one->row;
    set_task(row, task);
    row->trims = walk->length;
    row->fixed = 0;
    for (int k = 0; k < walk->length; k++) {
        int trim = level * a->trims + walk->trim[k], maneuver = k ? level * maneuvers + walk->maneuver[k] : 0;
        one->rate[k] = a->rate[trim];
        one->speed[k] = a->speed[trim];
        one->size_D[k] = k ? a->size[maneuver] : 0;
        one->turned[k] = k ? one->turned[k - 1] + a->turn[maneuver] : 0;
        if (k) row->fixed += a->duration[maneuver];
    }
    row->heading = task->heading - one->turned[walk->length - 1];
    row->rate = one->rate;
    row->speed = one->speed;
    row->size_D = one->size_D;
}

/* A vector turned by a factor, each part rounded once less: on every machine the bits that plans always had. */
static cplx rotated(cplx vector, cplx factor)
{
    double x = creal(vector), y = cimag(vector), c = creal(factor), s = cimag(factor);
    return fma(x, c, -(y * s)) + I * fma(x, s, y * c);
}

/* The rest: what the maneuvers before have turned is folded into the vectors. */
static void set_vectors(WalkRow *one, const Automaton *a, const Walk *walk, int level)
{
    int maneuvers = a->first[a->trims];
    cplx factor = 1;
    for (int k = 0; k < walk->length; k++) {
        one->D[k] = k ? rotated(a->displacement[level * maneuvers + walk->maneuver[k]], factor) : 0;
        factor = k ? turned(one->turned[k]) : 1;
        cplx W = one->W[k] = rotated(a->velocity[level * a->trims + walk->trim[k]], factor);
        one->C[k] = one->rate[k] != 0 ? cimag(W) * (1 / one->rate[k]) - I * (creal(W) * (1 / one->rate[k])) : 0;
        one->bearing_D[k] = k ? carg(one->D[k]) : 0;
        one->bearing_W[k] = carg(W);
    }
    Row *row = &one->row;
    row->W = one->W;
    row->C = one->C;
    row->D = one->D;
    row->bearing_D = one->bearing_D;
    row->bearing_W = one->bearing_W;
}

/* Seconds that a walk takes at least at one level. */
static double bound_of(const Row *row)
{
    Active on;
    choose(row, &on, (1u << row->trims) - 1);
    return row->fixed + MAX(least_time(row, &on, to_cover(row)), least_turning(row, &on));
}
