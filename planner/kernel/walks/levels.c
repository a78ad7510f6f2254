/* Pruning and solution of one walk at every uncertainty level. */
#include "walks.h"

#define NEAR_THE_EDGE 0.999 /* of the tolerance: the distance at which closed forms aim */
#define TIE 1e-12         /* of the incumbent's cost: smaller improvements are rounding */
#define POLISHING 0.1     /* of the seconds allowed, in addition to them */

/* The next level to bound: that with the largest lower bound; after many walks, the deciding level first. */
static int next_level(const Search *s, const double *bounds, int done)
{
    int level = 0;
    if (!done && s->examined >= MANY_WALKS) return s->deciding_level;
    for (int other = 1; other < s->automaton->levels; other++) if (bounds[other] > bounds[level]) level = other;
    return level;
}

/* Whether multipliers prune walks often enough; where they rarely do, most walks skip them. */
static int is_worth_bounding(Search *s)
{
    int rarely = s->bounded > MIN_TRIALS && s->pruned * RARE_SUCCESS < s->bounded;
    if (rarely && s->skipped++ % RARE_SUCCESS) return 0;
    s->bounded++;
    return 1;
}

/* Whether a lower bound at some level is no better than the incumbent. */
int pruned_by_bounds(Search *s, const Node *entry, Levels *every)
{
    int levels = s->automaton->levels;
    double bounds[MOST], best = s->answer->cost;
    read_walk(s->automaton, s->task, entry, &every->walk);
    for (int level = 0; level < levels; level++) {
        Problem *row = &every->level[level].problem;
        set_sizes(&every->level[level], s->automaton, s->task, &every->walk, level);
        set_vectors(&every->level[level], s->automaton, &every->walk, level);
        bounds[level] = lower_bound(row);
        row->best = best;
        row->multiplier = s->multiplier[level];
    }
    for (int done = 0; done < levels; done++) {
        int level = next_level(s, bounds, done);
        if (bounds[level] >= best) return 1;
        bounds[level] = -1;
        every->order[done] = level;
        Problem *row = &every->level[level].problem;
        s->answer->nodes++;
        if (best == INFINITY || !is_worth_bounding(s)) continue;
        int out = cannot_beat(row);
        s->pruned += out;
        s->multiplier[level] = row->multiplier;
        if (out) return 1;
    }
    return 0;
}

/* Solves a walk at every level and replaces the incumbent if the worst level is faster. With a limit on the number of
 * nonzero times, the goal is one point near the edge of the tolerance. Returns whether the incumbent was replaced. */
int improves_incumbent(Search *s, const Levels *every, int most)
{
    const SolveContext *context = most < MOST ? &s->first_pass : &s->second_pass;
    int levels = s->automaton->levels;
    double costs[MOST], times[MOST * MOST], worst = 0, enough = s->answer->cost;
    /* Among many walks of one cost, rounding makes none the better. */
    if (s->examined >= MANY_WALKS && enough < INFINITY) enough -= TIE * enough;
    for (int done = 0; done < levels; done++) {
        int level = every->order[done];
        Problem row = every->level[level].problem;
        row.best = enough;
        if (most < MOST) {
            double aside = NEAR_THE_EDGE * row.tolerance;
            row.goal += aside / length(row.multiplier) * row.multiplier;
            row.tolerance = 0;
        }
        solve_with(&row, most, context);
        if (!(row.best < enough)) {
            if (s->answer->cost == INFINITY) s->deciding_level = level;
            return 0;
        }
        costs[level] = row.best;
        worst = greater(worst, row.best);
        memcpy(times + level * MOST, row.times, sizeof(row.times));
    }
    s->answer->cost = worst;
    for (int level = 0; level < levels; level++) if (costs[level] == worst) s->deciding_level = level;
    s->best = every->walk;
    s->answer->trims = every->walk.length;
    for (int k = 0; k < every->walk.length; k++) s->answer->walk[k] = every->walk.trim[k];
    memcpy(s->answer->costs, costs, sizeof(costs));
    memcpy(s->answer->times, times, sizeof(times));
    return 1;
}

/* Solves the incumbent again at the levels that do not decide. */
void polish(Search *s)
{
    Answer *answer = s->answer;
    WalkProblem one;
    SolveContext context = {0, 0, s->second_pass.deadline + POLISHING * s->task->seconds};
    for (int level = 0; answer->trims && level < s->automaton->levels; level++) {
        set_sizes(&one, s->automaton, s->task, &s->best, level);
        set_vectors(&one, s->automaton, &s->best, level);
        one.problem.multiplier = first_multiplier(one.problem.goal);
        one.problem.best = answer->costs[level];
        memcpy(one.problem.times, answer->times + level * MOST, sizeof(one.problem.times));
        solve_with(&one.problem, MOST, &context);
        answer->costs[level] = one.problem.best;
        memcpy(answer->times + level * MOST, one.problem.times, sizeof(one.problem.times));
    }
}
