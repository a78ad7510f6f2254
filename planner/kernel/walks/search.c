/* The best walk: walks come one by one, the one with the least bound first. */
#include "walks.h"

#define SHORT 4           /* trims */
#define MANY 256          /* walks, from which on their sets of times are worth knowing */
#define NEARLY 1e-3       /* of the way, of the speed, rad: what makes little difference */
#define ROUNDED 1e-12     /* likewise: what makes none */

/* What there is room for, 140 MB in all: walks and beginnings that wait, beyond which they come depth first; walks that
 * were looked at, beyond which each is solved at once; and sets of times (with those of alike_sets.c). */
#define MOST_WAITING 1500000
#define MOST_LEFT 1000000
#define TRIED (1 << 17)
#define KNOWN (1 << 19)

/* Whether the nodes or the seconds allowed are used up. */
static int over(const Search *s) { return s->answer->nodes >= s->task->most_nodes || late(s->whole.until); }

/* Stops the search: nothing undercuts the bound given, nor those of the walks that are left. */
static void stop(Search *s, double bound)
{
    s->answer->complete = 0;
    for (long i = 0; i < s->left.count; i++) bound = lesser(bound, s->left.entries[i].bound);
    s->answer->bound = bound;
}

/* Looks at a walk: with as many times as equations only, which soon gives a plan that excludes most of the others.
 * One that has become the best is solved to the end at once. Returns whether there was time for it. */
static int looked_at(Search *s, const Entry *walk)
{
    Levels every;
    int equations = 2 + (s->task->wants_heading ? 1 : 0);
    if (++s->looked == MANY) s->quick.known = make_known_sets(TRIED, NEARLY, s->way, s->fastest, 1);
    if (!excluded(s, walk, &every)) {
        if (solved(s, &every, equations) || !has_room(&s->left, 1)) solved(s, &every, MOST);
        else append(&s->left, walk);
    }
    return !late(s->whole.until);
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
        if (over(s) || (one.closed && !looked_at(s, &one))) { stop(s, first->bound); return; }
        if (one.closed) continue;
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
        if (over(s) || (one.closed && !looked_at(s, &one))) { stop(s, one.bound); return; }
        if (one.closed) continue;
        if (!has_room(f, s->ways.room)) descend(s, &one, fewest, most);
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
    if (s->left.count > MANY) {
        s->whole.known = make_known_sets(KNOWN, ROUNDED, s->way, s->fastest, 0);
        s->whole.alike = make_alike_sets(s->way, s->fastest);
    }
    qsort(s->left.entries, (size_t)s->left.count, sizeof(Entry), in_order);
    for (long i = 0; i < s->left.count; i++) {
        Entry *one = &s->left.entries[i];
        if (one->bound >= s->answer->cost) break;
        int stopped = over(s);
        if (!stopped && !excluded(s, one, &every)) solved(s, &every, MOST);
        if (stopped || late(s->whole.until)) { s->answer->complete = 0; s->answer->bound = one->bound; return; }
    }
}

/* The sizes of things, for what makes a difference. */
static void set_scales(Search *s)
{
    const Automaton *a = s->automaton;
    s->way = cabs(s->task->goal_north + I * s->task->goal_east) + s->task->tolerance;
    for (int m = 0; m < a->levels * a->first[a->trims]; m++) s->way = greater(s->way, a->size[m]);
    for (int trim = 0; trim < a->levels * a->trims; trim++) s->fastest = greater(s->fastest, a->speed[trim]);
}

static int make_room(Search *s)
{
    const Automaton *a = s->automaton;
    int widest = 1;
    for (int trim = 0; trim < a->trims; trim++) widest = (int)larger(widest, a->first[trim + 1] - a->first[trim] + 1);
    s->frontier.most = MOST_WAITING;
    s->left.most = MOST_LEFT;
    s->ways.most = widest;
    s->stack.most = (long)widest * s->task->max_trims;
    return make_remaining(&s->remaining, a, s->task) && has_room(&s->ways, widest)
        && has_room(&s->stack, s->stack.most) && has_room(&s->frontier, widest);
}

/* The walk whose worst level is best; 1 where there is no memory. */
PUBLIC int search(const Task *task, const Automaton *automaton, Answer *answer)
{
    Search s = {.task = task, .automaton = automaton, .answer = answer};
    s.whole.until = s.quick.until = task->seconds < INFINITY ? clock_now() + task->seconds : INFINITY;
    answer->cost = INFINITY;
    answer->trims = answer->nodes = 0;
    answer->complete = 1;
    int made = make_room(&s), most = (int)task->max_trims;
    if (made) {
        set_scales(&s);
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
    free_known_sets(s.quick.known);
    free_known_sets(s.whole.known);
    free_alike_sets(s.whole.alike);
    return !made;
}
