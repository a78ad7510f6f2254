/* Walks of the maneuver automaton as problems of the solver. */
#include "walks.h"

void read_walk(const Automaton *a, const Task *task, const Node *entry, Walk *walk)
{
    walk->length = entry->trims;
    walk->trim[0] = (int)task->start_trim;
    for (int k = 1; k < entry->trims; k++) {
        walk->maneuver[k] = a->first[walk->trim[k - 1]] + entry->step[k - 1];
        walk->trim[k] = a->to[walk->maneuver[k]];
    }
}

/* A starting value: against the goal, at 5 m/s. */
cplx first_multiplier(cplx goal) { return cabs(goal) > 0 ? -0.2 * goal / cabs(goal) : -0.2; }

void set_task(Problem *row, const Task *task)
{
    row->goal = task->goal_north + I * task->goal_east;
    row->tolerance = task->tolerance;
    row->slack = task->slack;
    row->heading_slack = task->heading_slack;
    row->wants_heading = (int)task->wants_heading;
    row->heading_tolerance = task->heading_tolerance;
    row->straight = row->hardly_bent = 0;
}

/* Sets what lower bounds need: speeds, rates, lengths, and the heading change of all maneuvers. */
void set_sizes(WalkProblem *one, const Automaton *a, const Task *task, const Walk *walk, int level)
{
    int maneuvers = a->first[a->trims];
    Problem *row = &one->problem;
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

/* Rotates a vector by a unit factor with two roundings a part, not three. */
static cplx rotated(cplx vector, cplx factor)
{
    double x = creal(vector), y = cimag(vector), c = creal(factor), s = cimag(factor);
    return fma(x, c, -(y * s)) + I * fma(x, s, y * c);
}

/* Sets the vectors, rotated by the heading changes of the maneuvers before. */
void set_vectors(WalkProblem *one, const Automaton *a, const Walk *walk, int level)
{
    int maneuvers = a->first[a->trims];
    cplx factor = 1;
    for (int k = 0; k < walk->length; k++) {
        one->D[k] = k ? rotated(a->displacement[level * maneuvers + walk->maneuver[k]], factor) : 0;
        factor = k ? unit_complex(one->turned[k]) : 1;
        cplx W = one->W[k] = rotated(a->velocity[level * a->trims + walk->trim[k]], factor);
        one->C[k] = one->rate[k] != 0 ? cimag(W) * (1 / one->rate[k]) - I * (creal(W) * (1 / one->rate[k])) : 0;
        one->bearing_D[k] = k ? carg(one->D[k]) : 0;
        one->bearing_W[k] = carg(W);
    }
    Problem *row = &one->problem;
    row->W = one->W;
    row->C = one->C;
    row->D = one->D;
    row->bearing_D = one->bearing_D;
    row->bearing_W = one->bearing_W;
}
