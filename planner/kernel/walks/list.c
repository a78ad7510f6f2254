/* The most promising walks. */
#include "walks.h"

/* The walks of least bound, at most so many, whose bounds are below a limit: their trims, and how many each has.
 * Returns how many they are, -1 where there is no memory; rest: seconds that all others take at least. */
PUBLIC long list_walks(const Task *task, const Automaton *automaton, double limit, long most, long *trims, long *lengths,
                       double *rest)
{
    Answer answer = {.cost = limit};
    Search s = {.task = task, .automaton = automaton, .answer = &answer};
    double until = task->seconds < INFINITY ? clock_now() + task->seconds : INFINITY;
    Frontier *f = &s.frontier;
    Entry first = {.trims = 1};
    long count = 0;
    int made = make_room(&s);
    *rest = limit;
    if (made) push(f, &first);
    while (f->count) {
        Entry one = pop(f);
        if (count == most || late(until) || !has_room(f, s.ways.room)) {
            *rest = one.bound;
            break;
        }
        if (one.closed) {
            Walk walk;
            read_walk(automaton, task, &one, &walk);
            for (int k = 0; k < walk.length; k++) trims[MOST * count + k] = walk.trim[k];
            lengths[count++] = walk.length;
            continue;
        }
        find_ways(&s, &one, 1, (int)task->max_trims);
        for (long i = 0; i < s.ways.count; i++) push(f, &s.ways.entries[i]);
    }
    free_room(&s);
    return made ? count : -1;
}
