/* One walk at every level: excluded by a bound, or solved. */
#include "frontier.c"

typedef struct {
    double cost, bound, least, times[MOST * MOST], costs[MOST];
    long trims, walk[MOST], nodes, complete;
} Answer;

#define SHORT 4           /* trims */
#define NEAR_THE_EDGE 0.999 /* of the tolerance: where closed forms aim */
#define POLISHING 0.1     /* of the seconds allowed, on top of them */

typedef struct {
    const Task *task;
    const Automaton *automaton;
    Answer *answer;
    Known tried, known;       /* sets of times: with as many as equations, tried once; with all */
    Alike alike;
    long looked;              /* walks that were looked at */
    Help quick, whole;        /* for the times of a walk: with as many as equations only, and with all */
    cplx worth[MOST];         /* s/m; at each level, a multiplier that was good for the walk before */
    Remaining remaining;
    Walk best;
    Frontier frontier;
    Frontier left;            /* walks that were looked at and not excluded */
    Frontier ways, stack;     /* ways on from one walk; what waits to be followed depth first */
} Search;

/* One walk at every level, in the order in which they are looked at: the one with the largest bound first. */
typedef struct { Walk walk; WalkRow level[MOST]; int order[MOST]; } Levels;

/* Whether the nodes or the seconds allowed are used up. */
static int over(const Search *s)
{
    return s->answer->nodes >= s->task->most_nodes || late(s->whole.until);
}

/* Whether some level cannot beat the best so far. */
static int excluded(Search *s, const Entry *entry, Levels *every)
{
    int levels = s->automaton->levels;
    double bounds[MOST], best = s->answer->cost;
    read_walk(s->automaton, s->task, entry, &every->walk);
    for (int level = 0; level < levels; level++) {
        Row *row = &every->level[level].row;
        set_sizes(&every->level[level], s->automaton, s->task, &every->walk, level);
        set_vectors(&every->level[level], s->automaton, &every->walk, level);
        bounds[level] = bound_of(row);
        row->best = best;
        row->worth = s->worth[level];
    }
    for (int done = 0; done < levels; done++) {
        int level = 0;
        for (int other = 1; other < levels; other++) if (bounds[other] > bounds[level]) level = other;
        if (bounds[level] >= best) return 1;
        bounds[level] = -1;
        every->order[done] = level;
        Row *row = &every->level[level].row;
        s->answer->nodes++;
        if (best == INFINITY) continue;
        Active all;
        unsigned mask = (1u << row->trims) - 1;
        choose(row, &all, mask);
        if (out_of_reach(row, &all, best - row->fixed)) return 1;
        int out = refuted(row, mask, ROUNDS, &row->worth);
        s->worth[level] = row->worth;
        if (out) return 1;
    }
    return 0;
}

/* Solves a walk at every level; keeps it if its worst level is best. With a limit, no more times are not 0, and the
 * goal is the point where the tolerance is used up best. Returns whether it was kept. */
static int solved(Search *s, const Levels *every, int most)
{
    const Help *help = most < MOST ? &s->quick : &s->whole;
    int levels = s->automaton->levels;
    double costs[MOST], times[MOST * MOST], worst = 0;
    for (int done = 0; done < levels; done++) {
        int level = every->order[done];
        Row row = every->level[level].row;
        row.best = s->answer->cost;
        if (most < MOST) {
            double aside = MAX(0, NEAR_THE_EDGE * row.tolerance - 4e-7);
            row.goal += aside / length(row.worth) * row.worth;
            row.tolerance = 0;
        }
        solve(&row, most, help);
        if (!(row.best < s->answer->cost)) return 0;
        costs[level] = row.best;
        worst = MAX(worst, row.best);
        memcpy(times + level * MOST, row.times, sizeof(row.times));
    }
    s->answer->cost = worst;
    s->best = every->walk;
    s->answer->trims = every->walk.length;
    for (int k = 0; k < every->walk.length; k++) s->answer->walk[k] = every->walk.trim[k];
    memcpy(s->answer->costs, costs, sizeof(costs));
    memcpy(s->answer->times, times, sizeof(times));
    return 1;
}

/* The winner once more at the levels that do not decide. */
static void polish(Search *s)
{
    Answer *answer = s->answer;
    WalkRow one;
    Help help = {0, 0, s->whole.until + POLISHING * s->task->seconds};
    for (int level = 0; answer->trims && level < s->automaton->levels; level++) {
        set_sizes(&one, s->automaton, s->task, &s->best, level);
        set_vectors(&one, s->automaton, &s->best, level);
        one.row.worth = first_worth(one.row.goal);
        one.row.best = answer->costs[level];
        memcpy(one.row.times, answer->times + level * MOST, sizeof(one.row.times));
        solve(&one.row, MOST, &help);
        answer->costs[level] = one.row.best;
        memcpy(answer->times + level * MOST, one.row.times, sizeof(one.row.times));
    }
}
