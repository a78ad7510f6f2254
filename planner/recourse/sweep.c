/* Sweeps of value iteration over one trim's nodes on one grid, and costs of the actions from one state. */
#include <stdint.h>
#include <stdlib.h>

#include "recourse.h"

enum { ALL, LIKELY, CHOSEN };

/* Computes rows of nodes into `made`; the table itself is only read, so that rows may be shared out at will. Of ALL
 * actions it keeps the best in `choice`, and in `likely` a bit for each that is less than `margin` slower; of the
 * LIKELY ones it keeps the best; CHOSEN keeps the choice. `change` is the largest rise and the largest fall of a value,
 * as a share of the seconds that the best action takes, or for the fall any action. */
PUBLIC void sweep(const Table *t, const Actions *p, int trim, int level, int from, int to, int mode, double margin,
                  float *made, unsigned char *choice, uint64_t *likely, double *change)
{
    int side = 2 * t->half + 1, first = p->first[trim], actions = p->first[trim + 1] - first;
    int inner = level ? t->half / RATIO : 0, outer = level == t->levels - 1 ? t->outer : t->half;
    const float *old = t->value + ((long)trim * t->levels + level) * side * side;
    double step = t->step, cost[MOST_ACTIONS];
    for (int k = 0; k < level; k++) step *= RATIO;
    for (int i = from; i < to; i++) {
        for (int j = 0; j < side; j++) {
            int u = i - t->half, v = j - t->half, node = i * side + j;
            made[node] = old[node];
            int steps = abs(u) > abs(v) ? abs(u) : abs(v);
            if (steps < inner || steps > outer || old[node] < 0) continue;
            if (mode == CHOSEN) {
                made[node] = (float)action_cost(t, p, first + choice[node], NO_SHIFT, step * u, step * v);
                continue;
            }
            double best = INFINITY;
            for (int k = 0; k < actions; k++) {
                cost[k] = INFINITY;
                if (level > p->coarsest[first + k] || (mode == LIKELY && !(likely[node] >> k & 1))) continue;
                cost[k] = action_cost(t, p, first + k, NO_SHIFT, step * u, step * v);
                change[1] = greater(change[1], (old[node] - cost[k]) / p->mean[first + k]);
                if (!(cost[k] < best)) continue;
                best = cost[k];
                choice[node] = (unsigned char)k;
            }
            change[0] = greater(change[0], (best - old[node]) / p->mean[first + choice[node]]);
            made[node] = (float)best;
            if (mode != ALL) continue;
            likely[node] = 0;
            for (int k = 0; k < actions; k++) likely[node] |= (uint64_t)(cost[k] < best + margin) << k;
        }
    }
}

/* The cost of every action from each of several states, one row a state, as long as the most actions of a trim; so
 * are the rows of shifts. */
PUBLIC void action_costs(const Table *t, const Actions *p, int states, const int *trim, const double *position,
                         const double *shift, int most, double *cost)
{
    for (int n = 0; n < states; n++) {
        double x = position[2 * n], y = position[2 * n + 1];
        int first = p->first[trim[n]], actions = p->first[trim[n] + 1] - first, level = level_of(t, x, y);
        for (int k = 0; k < most; k++) {
            int considered = k < actions && level <= p->coarsest[first + k];
            cost[n * most + k] =
                considered ? action_cost(t, p, first + k, shift + 5 * (n * most + k), x, y) : INFINITY;
        }
    }
}

PUBLIC void values(const Table *t, int states, const int *trim, const double *position, double *cost)
{
    for (int n = 0; n < states; n++) cost[n] = look_up(t, trim[n], position[2 * n], position[2 * n + 1]);
}
