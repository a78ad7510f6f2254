/* The best walk: walks come one by one, the one with the least bound first. */
#include "walks.h"
#include <time.h>

typedef struct {
    double cost, bound, least, times[MOST * MOST], costs[MOST];
    long trims, walk[MOST], nodes, complete;
} Answer;

#define SHORT 4           /* trims */
#define NEAR_THE_EDGE 0.999 /* of the tolerance: where closed forms aim */
#define MOST_WAITING 2000000 /* entries of a frontier; beyond, walks come depth first */

typedef struct {
    const Task *task;
    const Automaton *automaton;
    Answer *answer;
    double until;             /* s */
    cplx multiplier[MOST];         /* s/m; at each level, a multiplier that was good for the walk before */
    Remaining remaining;
    Walk best;
    Frontier frontier;
    Frontier left;            /* walks that were looked at and not excluded */
    Frontier ways, stack;     /* ways on from one walk; what waits to be followed depth first */
} Search;

/* One walk at every level, in the order in which they are looked at: the one with the largest bound first. */
typedef struct { Walk walk; WalkProblem level[MOST]; int order[MOST]; } Levels;

static double clock_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Whether the nodes or the seconds allowed are used up. */
static int over(const Search *s)
{
    return s->answer->nodes >= s->task->most_nodes || (s->until < INFINITY && clock_now() >= s->until);
}

/* Whether some level cannot beat the best so far. */
static int excluded(Search *s, const Entry *entry, Levels *every)
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
        int level = 0;
        for (int other = 1; other < levels; other++) if (bounds[other] > bounds[level]) level = other;
        if (bounds[level] >= best) return 1;
        bounds[level] = -1;
        every->order[done] = level;
        Problem *row = &every->level[level].problem;
        s->answer->nodes++;
        if (best == INFINITY) continue;
        int out = cannot_beat(row);
        s->multiplier[level] = row->multiplier;
        if (out) return 1;
    }
    return 0;
}

/* Solves a walk at every level; keeps it if its worst level is best. With a limit, no more times are not 0, and the
 * goal is the point where the tolerance is used up best. Returns whether it was kept. */
static int solved(Search *s, const Levels *every, int most)
{
    int levels = s->automaton->levels;
    double costs[MOST], times[MOST * MOST], worst = 0;
    for (int done = 0; done < levels; done++) {
        int level = every->order[done];
        Problem row = every->level[level].problem;
        row.best = s->answer->cost;
        if (most < MOST) {
            double aside = NEAR_THE_EDGE * row.tolerance;
            row.goal += aside / length(row.multiplier) * row.multiplier;
            row.tolerance = 0;
        }
        solve(&row, most);
        if (!(row.best < s->answer->cost)) return 0;
        costs[level] = row.best;
        worst = greater(worst, row.best);
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

/* Stops the search: nothing undercuts the bound given, nor those of the walks that are left. */
static void stop(Search *s, double bound)
{
    s->answer->complete = 0;
    for (long i = 0; i < s->left.count; i++) bound = lesser(bound, s->left.entries[i].bound);
    s->answer->bound = bound;
}

/* Looks at a walk: with as many times as equations only, which soon gives a plan that excludes most of the others.
 * One that has become the best is solved to the end at once. */
static void look_at(Search *s, const Entry *walk)
{
    Levels every;
    int equations = 2 + (s->task->wants_heading ? 1 : 0);
    s->answer->least = lesser(s->answer->least, walk->bound);
    if (excluded(s, walk, &every)) return;
    if (solved(s, &every, equations) || !has_room(&s->left, 1)) solved(s, &every, MOST);
    else append(&s->left, walk);
}

/* The bound of a walk at its worst level. */
static double bound_of_walk(const Search *s, const Walk *walk)
{
    double bound = 0;
    WalkProblem one;
    for (int level = 0; level < s->automaton->levels; level++) {
        set_sizes(&one, s->automaton, s->task, walk, level);
        bound = greater(bound, lower_bound(&one.problem));
    }
    return bound;
}

/* What all walks have in common that begin alike, at every level. */
static void begin(const Search *s, const Walk *walk, Beginning *begun)
{
    const Automaton *a = s->automaton;
    int maneuvers = a->first[a->trims];
    double distance = cabs(s->task->goal_north + I * s->task->goal_east) - s->task->tolerance - s->task->slack;
    for (int level = 0; level < a->levels; level++) {
        Beginning *one = &begun[level];
        *one = (Beginning){.distance = distance};
        for (int k = 0; k < walk->length; k++) {
            one->group = (int)larger(one->group, s->remaining.group[level * a->trims + walk->trim[k]]);
            if (!k) continue;
            one->fixed += a->duration[level * maneuvers + walk->maneuver[k]];
            one->distance -= a->size[level * maneuvers + walk->maneuver[k]];
        }
    }
}

/* The bound of all walks that go on with one more trim. */
static double bound_beyond(const Search *s, const Beginning *begun, int maneuver, int left)
{
    const Automaton *a = s->automaton;
    double bound = 0;
    for (int level = 0; level < a->levels; level++) {
        int at = level * a->first[a->trims] + maneuver, group = s->remaining.group[level * a->trims + a->to[maneuver]];
        Beginning one = {begun[level].fixed + a->duration[at], begun[level].distance - a->size[at],
                     (int)larger(begun[level].group, group)};
        bound = greater(bound, least_seconds(&s->remaining, level, &one, a->to[maneuver], left));
    }
    return bound;
}

/* The walk itself, and the ways on from it, unless some bound excludes them. */
static void find_ways(Search *s, const Entry *entry, int fewest, int most)
{
    Walk walk;
    Beginning begun[MOST];
    const Automaton *a = s->automaton;
    Entry next = *entry;
    read_walk(a, s->task, entry, &walk);
    int trim = walk.trim[walk.length - 1];
    s->ways.count = 0;
    if (walk.length >= fewest && (s->task->goal_trim < 0 || trim == s->task->goal_trim)) {
        next.closed = 1;
        next.bound = bound_of_walk(s, &walk);
        if (next.bound < s->answer->cost) append(&s->ways, &next);
    }
    if (walk.length == most) return;
    begin(s, &walk, begun);
    next.closed = 0;
    next.trims++;
    for (int m = a->first[trim]; m < a->first[trim + 1]; m++) {
        next.bound = greater(entry->bound, bound_beyond(s, begun, m, most - next.trims));
        next.step[walk.length - 1] = (unsigned short)(m - a->first[trim]);
        if (next.bound < s->answer->cost) append(&s->ways, &next);
    }
}

/* Looks at all walks that begin alike, depth first. */
static void descend(Search *s, const Entry *first, int fewest, int most)
{
    Frontier *stack = &s->stack, *ways = &s->ways;
    stack->count = 0;
    append(stack, first);
    while (stack->count) {
        Entry one = stack->entries[--stack->count];
        if (one.bound >= s->answer->cost) continue;
        if (over(s)) { stop(s, first->bound); return; }
        if (one.closed) { look_at(s, &one); continue; }
        find_ways(s, &one, fewest, most);
        qsort(ways->entries, (size_t)ways->count, sizeof(Entry), in_order);
        while (ways->count) append(stack, &ways->entries[--ways->count]);
    }
}

/* Looks at all walks of so many trims, by bound. */
static void dive(Search *s, int fewest, int most)
{
    Frontier *f = &s->frontier;
    Entry first = {.trims = 1};
    f->count = 0;
    push(f, &first);
    while (f->count && s->answer->complete) {
        Entry one = pop(f);
        if (one.bound >= s->answer->cost) break;
        if (over(s)) { stop(s, one.bound); return; }
        if (one.closed) look_at(s, &one);
        else if (!has_room(f, s->ways.room)) descend(s, &one, fewest, most);
        else {
            find_ways(s, &one, fewest, most);
            for (long i = 0; i < s->ways.count; i++) push(f, &s->ways.entries[i]);
        }
    }
}

/* Solves what is left, with every set of times. */
static void finish(Search *s)
{
    Levels every;
    qsort(s->left.entries, (size_t)s->left.count, sizeof(Entry), in_order);
    for (long i = 0; i < s->left.count; i++) {
        Entry *one = &s->left.entries[i];
        if (one->bound >= s->answer->cost) break;
        if (over(s)) { s->answer->complete = 0; s->answer->bound = one->bound; return; }
        if (!excluded(s, one, &every)) solved(s, &every, MOST);
    }
}

/* The winner once more at the levels that do not decide. */
static void polish(Search *s)
{
    Answer *answer = s->answer;
    WalkProblem one;
    for (int level = 0; answer->trims && level < s->automaton->levels; level++) {
        set_sizes(&one, s->automaton, s->task, &s->best, level);
        set_vectors(&one, s->automaton, &s->best, level);
        one.problem.multiplier = first_multiplier(one.problem.goal);
        one.problem.best = answer->costs[level];
        memcpy(one.problem.times, answer->times + level * MOST, sizeof(one.problem.times));
        solve(&one.problem, MOST);
        answer->costs[level] = one.problem.best;
        memcpy(answer->times + level * MOST, one.problem.times, sizeof(one.problem.times));
    }
}

static int make_room(Search *s)
{
    const Automaton *a = s->automaton;
    int widest = 1;
    for (int trim = 0; trim < a->trims; trim++) widest = (int)larger(widest, a->first[trim + 1] - a->first[trim] + 1);
    s->frontier.most = s->left.most = MOST_WAITING;
    s->ways.most = widest;
    s->stack.most = (long)widest * s->task->max_trims;
    return make_remaining(&s->remaining, a, s->task) && has_room(&s->ways, widest)
        && has_room(&s->stack, s->stack.most) && has_room(&s->frontier, widest);
}

/* The walk whose worst level is best; 1 where there is no memory. */
PUBLIC int search(const Task *task, const Automaton *automaton, Answer *answer)
{
    Search s = {.task = task, .automaton = automaton, .answer = answer, .until = INFINITY};
    if (task->seconds < INFINITY) s.until = clock_now() + task->seconds;
    answer->cost = answer->least = INFINITY;
    answer->trims = answer->nodes = 0;
    answer->complete = 1;
    int made = make_room(&s), most = (int)task->max_trims;
    if (made) {
        for (int level = 0; level < automaton->levels; level++)
            s.multiplier[level] = first_multiplier(task->goal_north + I * task->goal_east);
        dive(&s, 1, (int)smaller(SHORT, most));
        if (answer->complete && most > SHORT) dive(&s, SHORT + 1, most);
        if (answer->complete) finish(&s);
        polish(&s);
        if (answer->complete || answer->bound > answer->cost) answer->bound = answer->cost;
    }
    free_remaining(&s.remaining);
    free(s.frontier.entries);
    free(s.left.entries);
    free(s.ways.entries);
    free(s.stack.entries);
    return !made;
}
