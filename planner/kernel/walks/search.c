/* The best walk: walks come one by one, the one with the least bound first. */
#include "walks.h"

#define SHORT 4           /* trims */
#define WAYS 1000         /* ways on from walks, that take as long to find as a node to solve, or longer */
#define NEARLY 1e-3       /* of the way, of the speed, rad: what makes little difference */
#define ROUNDED 1e-12     /* likewise: what makes none */

#define TRIED (1 << 17)   /* sets of times that there is room for: 5 MB ... */
#define KNOWN (1 << 19)   /* ... and 20 MB; alike_sets.c has 52 MB */

/* Whether the nodes or the seconds allowed are used up. */
static int over(const Search *s)
{
    return s->answer->nodes + s->found / WAYS >= s->task->most_nodes || late(s->whole.until);
}

/* Looks at a walk: with as many times as equations only, which soon gives a plan that excludes most of the others.
 * One that has become the best is solved to the end at once. Returns whether there was time for it. */
static int looked_at(Search *s, const Entry *walk)
{
    Levels every;
    int equations = 2 + (s->task->wants_heading ? 1 : 0);
    if (++s->looked == MANY) s->quick.known = make_known_sets(TRIED, NEARLY, s->way, s->fastest, 1);
    if (excluded(s, walk, &every)) return 1;
    int hopeful = s->looked - s->better <= larger(PATIENCE, s->better), kept = hopeful && solved(s, &every, equations);
    if (kept) s->better = s->looked;
    if (kept || !has_room(&s->left, 1)) solved(s, &every, MOST);
    else append(&s->left, walk);
    return !late(s->whole.until);
}

/* Stops the search: nothing undercuts the bound given, nor those of the walks that are left, nor of longer ones. */
static void stop(Search *s, double bound, int most)
{
    s->answer->complete = 0;
    if (most < s->task->max_trims) bound = lesser(bound, bound_of_all(s));
    for (long i = 0; i < s->left.count; i++) bound = lesser(bound, s->left.entries[i].bound);
    s->answer->bound = bound;
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
        if (over(s) || (one.closed && !looked_at(s, &one))) { stop(s, first->bound, most); return; }
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
        if (over(s) || (one.closed && !looked_at(s, &one))) { stop(s, one.bound, most); return; }
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
        for (int level = 0; level < automaton->levels; level++)
            s.multiplier[level] = first_multiplier(task->goal_north + I * task->goal_east);
        dive(&s, 1, (int)smaller(SHORT, most));
        if (answer->complete && most > SHORT) dive(&s, SHORT + 1, most);
        if (answer->complete) finish(&s);
        polish(&s);
        if (answer->complete || answer->bound > answer->cost) answer->bound = answer->cost;
    }
    free_room(&s);
    free_known_sets(s.quick.known);
    free_known_sets(s.whole.known);
    free_alike_sets(s.whole.alike);
    return !made;
}
