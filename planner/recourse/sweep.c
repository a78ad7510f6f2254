/* Sweeps of value iteration over one trim's nodes on one grid, and costs of the actions from one state. */
#include "recourse.h"

enum { IMPROVE, EVALUATE };

/* Takes rows of nodes to `made` and `choice`; the table itself is only read, so rows may be shared out at will.
 * `change` is the largest rise and the largest fall of a value, each as a share of the seconds that the best action
 * takes, or for the fall any action. With EVALUATE the action chosen before is kept. */
PUBLIC void sweep(const Table *t, const Actions *p, int trim, int level, int from, int to, int mode, float *made,
                  unsigned char *choice, double *change)
{
    int side = 2 * t->half + 1, inner = level ? t->half / 2 : 0, first = p->first[trim], last = p->first[trim + 1];
    const float *old = t->value + ((long)trim * t->levels + level) * side * side;
    double step = t->step * (double)(1 << level);
    for (int i = from; i < to; i++) {
        for (int j = 0; j < side; j++) {
            int u = i - t->half, v = j - t->half, node = i * side + j;
            made[node] = old[node];
            if ((u > -inner && u < inner && v > -inner && v < inner) || old[node] < 0) continue;
            double best = INFINITY;
            if (mode == EVALUATE) {
                best = action_cost(t, p, first + choice[node], step * u, step * v);
            } else {
                for (int action = first; action < last; action++) {
                    double cost = action_cost(t, p, action, step * u, step * v);
                    change[1] = greater(change[1], (old[node] - cost) / p->mean[action]);
                    if (!(cost < best)) continue;
                    best = cost;
                    choice[node] = (unsigned char)(action - first);
                }
                change[0] = greater(change[0], (best - old[node]) / p->mean[first + choice[node]]);
            }
            made[node] = (float)best;
        }
    }
}

/* The cost of every action from each of several states, one row a state, as long as the most actions of a trim. */
PUBLIC void action_costs(const Table *t, const Actions *p, int states, const int *trim, const double *position,
                         int most, double *cost)
{
    for (int n = 0; n < states; n++)
        for (int k = 0; k < most; k++) {
            int action = p->first[trim[n]] + k;
            cost[n * most + k] = action < p->first[trim[n] + 1]
                                     ? action_cost(t, p, action, position[2 * n], position[2 * n + 1])
                                     : INFINITY;
        }
}

PUBLIC void values(const Table *t, int states, const int *trim, const double *position, double *cost)
{
    for (int n = 0; n < states; n++) cost[n] = look_up(t, trim[n], position[2 * n], position[2 * n + 1]);
}
