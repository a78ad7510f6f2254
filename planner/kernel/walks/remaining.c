/* Lower bounds of the continuations of a walk, by trim and number of trims left.
 *
 * If v is the speed of its fastest trim, a walk takes at least
 *
 *     duration of its maneuvers + (distance - displacement of its maneuvers) / v,
 *
 * a sum over maneuvers: the least over all continuations follows by dynamic programming. The fastest trim is not known
 * beforehand, so the sum is minimised for several groups of speeds, and once for the durations alone.
 */
#include "walks.h"

static const double *least_from(const Remaining *r, int level, int speed, int left)
{
    return r->least + (((long)level * (SPEEDS + 1) + speed) * r->depth + left) * r->trims;
}

static int ascending(const void *one, const void *other)
{
    double a = *(const double *)one, b = *(const double *)other;
    return (a > b) - (a < b);
}

/* Groups the trims of a level by speed. */
static void group_speeds(Remaining *r, const Automaton *a, int level, double *sorted)
{
    const double *speed = a->speed + (long)level * a->trims;
    int different = 0, groups;
    memcpy(sorted, speed, sizeof(double) * (size_t)a->trims);
    qsort(sorted, (size_t)a->trims, sizeof(double), ascending);
    for (int i = 0; i < a->trims; i++)
        if (!i || sorted[i] > sorted[different - 1]) sorted[different++] = sorted[i];
    groups = r->speeds[level] = different < SPEEDS ? different : SPEEDS;
    for (int g = 0; g < groups; g++) {
        double fastest = sorted[(g + 1) * different / groups - 1];
        /* In hover no distance is covered: any slowness is valid. */
        r->slowness[level][g] = 1 / (fastest > 0 ? fastest : different > 1 ? sorted[1] : 1);
    }
    for (int i = 0; i < a->trims; i++) {
        int g = 0;
        while (speed[i] > sorted[(g + 1) * different / groups - 1]) g++;
        r->group[level * a->trims + i] = g;
    }
}

/* Dynamic programming for one level and one group of speeds. */
static void find_least(Remaining *r, const Automaton *a, const Task *task, int level, int speed)
{
    long maneuvers = a->first[a->trims];
    const double *duration = a->duration + level * maneuvers, *size = a->size + level * maneuvers;
    int groups = r->speeds[level];
    double slowness = speed < groups ? r->slowness[level][speed] : 0;
    for (int left = 0; left < r->depth; left++) {
        double *least = (double *)least_from(r, level, speed, left);
        const double *shorter = left ? least - a->trims : 0;
        for (int trim = 0; trim < a->trims; trim++) {
            least[trim] = task->goal_trim < 0 || trim == task->goal_trim ? 0 : INFINITY;
            if (speed < groups && r->group[level * a->trims + trim] > speed) { least[trim] = INFINITY; continue; }
            for (int m = a->first[trim]; left && m < a->first[trim + 1]; m++)
                least[trim] = lesser(least[trim], duration[m] - slowness * size[m] + shorter[a->to[m]]);
        }
    }
}

int make_remaining(Remaining *r, const Automaton *a, const Task *task)
{
    r->trims = a->trims;
    r->depth = (int)task->max_trims;
    r->group = malloc(sizeof(int) * (size_t)(a->levels * a->trims));
    r->least = malloc(sizeof(double) * (size_t)(a->levels * (SPEEDS + 1) * r->depth) * (size_t)a->trims);
    double *sorted = malloc(sizeof(double) * (size_t)a->trims);
    int made = r->group && r->least && sorted;
    for (int level = 0; made && level < a->levels; level++) {
        group_speeds(r, a, level, sorted);
        for (int speed = 0; speed < r->speeds[level]; speed++) find_least(r, a, task, level, speed);
        find_least(r, a, task, level, SPEEDS);
    }
    free(sorted);
    return made;
}

void free_remaining(Remaining *r) { free(r->group); free(r->least); }

/* Lower bound of all walks with a prefix, a last trim, and at most so many trims more. */
double least_seconds(const Remaining *r, int level, const Prefix *prefix, int trim, int left)
{
    double least = INFINITY, alone = least_from(r, level, SPEEDS, left)[trim];
    for (int g = prefix->group; g < r->speeds[level]; g++)
        least = lesser(least, r->slowness[level][g] * prefix->distance + least_from(r, level, g, left)[trim]);
    least = prefix->fixed + greater(least, alone);
    /* Not above the bound of a single walk through rounding. */
    return least - 1e-12 * fabs(least);
}
