/* One walk at every level: excluded by a bound, or solved. */
#include "walks.h"

#define NEAR_THE_EDGE 0.999 /* of the tolerance: where closed forms aim */
#define TIE 1e-12         /* of the best seconds */
#define POLISHING 0.1     /* of the seconds allowed, on top of them */

/* The level to look at next: that with the largest bound; where many walks were looked at, first the one that decided the best
 * walk, or without one that at which the walk before does not reach the goal. */
static int next_level(const Search *s, const double *bounds, int done)
{
    int level = 0;
    if (!done && s->looked >= MANY) return s->telling;
    for (int other = 1; other < s->automaton->levels; other++) if (bounds[other] > bounds[level]) level = other;
    return level;
}

/* Whether bounds exclude walks often enough to be computed; where they do not, some still are. */
static int is_worth_bounding(Search *s)
{
    int rarely = s->bounded > TRIALS && s->excluded * RARELY < s->bounded;
    if (rarely && s->passed++ % RARELY) return 0;
    s->bounded++;
    return 1;
}

/* Whether some level cannot beat the best so far. */
int excluded(Search *s, const Entry *entry, Levels *every)
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
        s->excluded += out;
        s->multiplier[level] = row->multiplier;
        if (out) return 1;
    }
    return 0;
}

/* Solves a walk at every level; keeps it if its worst level is best. With a limit, no more times are not 0, and the
 * goal is the point where the tolerance is used up best. Returns whether it was kept. */
int solved(Search *s, const Levels *every, int most)
{
    const Help *help = most < MOST ? &s->quick : &s->whole;
    int levels = s->automaton->levels;
    double costs[MOST], times[MOST * MOST], worst = 0, enough = s->answer->cost;
    /* Among many walks that take as long, rounding makes none the better. */
    if (s->looked >= MANY && enough < INFINITY) enough -= TIE * enough;
    for (int done = 0; done < levels; done++) {
        int level = every->order[done];
        Problem row = every->level[level].problem;
        row.best = enough;
        if (most < MOST) {
            double aside = NEAR_THE_EDGE * row.tolerance;
            row.goal += aside / length(row.multiplier) * row.multiplier;
            row.tolerance = 0;
        }
        solve_with(&row, most, help);
        if (!(row.best < enough)) {
            if (s->answer->cost == INFINITY) s->telling = level;
            return 0;
        }
        costs[level] = row.best;
        worst = greater(worst, row.best);
        memcpy(times + level * MOST, row.times, sizeof(row.times));
    }
    s->answer->cost = worst;
    for (int level = 0; level < levels; level++) if (costs[level] == worst) s->telling = level;
    s->best = every->walk;
    s->answer->trims = every->walk.length;
    for (int k = 0; k < every->walk.length; k++) s->answer->walk[k] = every->walk.trim[k];
    memcpy(s->answer->costs, costs, sizeof(costs));
    memcpy(s->answer->times, times, sizeof(times));
    return 1;
}

/* The winner once more at the levels that do not decide. */
void polish(Search *s)
{
    Answer *answer = s->answer;
    WalkProblem one;
    Help help = {0, 0, s->whole.until + POLISHING * s->task->seconds};
    for (int level = 0; answer->trims && level < s->automaton->levels; level++) {
        set_sizes(&one, s->automaton, s->task, &s->best, level);
        set_vectors(&one, s->automaton, &s->best, level);
        one.problem.multiplier = first_multiplier(one.problem.goal);
        one.problem.best = answer->costs[level];
        memcpy(one.problem.times, answer->times + level * MOST, sizeof(one.problem.times));
        solve_with(&one.problem, MOST, &help);
        answer->costs[level] = one.problem.best;
        memcpy(answer->times + level * MOST, one.problem.times, sizeof(one.problem.times));
    }
}
