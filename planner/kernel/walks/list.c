/* List of the walks with the least lower bounds. */
#include "walks.h"

/* Lists at most so many walks, least lower bound first, with bounds below a limit: their trims and lengths. Returns
 * their number, -1 without memory; *rest becomes the lower bound of all other walks. */
PUBLIC long list_walks(const Task *task, const Automaton *automaton, double limit, long most, long *trims,
                       long *lengths, double *rest)
{
    Answer answer = {.cost = limit};
    Search s = {.task = task, .automaton = automaton, .answer = &answer};
    double deadline = task->seconds < INFINITY ? clock_now() + task->seconds : INFINITY;
    Frontier *f = &s.frontier;
    Node first = {.trims = 1};
    long count = 0;
    int made = allocate(&s);
    *rest = limit;
    if (made) push(f, &first);
    while (f->count) {
        Node one = pop(f);
        if (count == most || past_deadline(deadline) || !reserve(f, s.branches.capacity)) {
            *rest = one.bound;
            break;
        }
        if (one.leaf) {
            Walk walk;
            read_walk(automaton, task, &one, &walk);
            for (int k = 0; k < walk.length; k++) trims[MOST * count + k] = walk.trim[k];
            lengths[count++] = walk.length;
            continue;
        }
        branch(&s, &one, 1, (int)task->max_trims);
        for (long i = 0; i < s.branches.count; i++) push(f, &s.branches.entries[i]);
    }
    release(&s);
    return made ? count : -1;
}
