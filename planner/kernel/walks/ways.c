/* The ways on from the beginning of a walk, and what bounds them. */
#include "walks.h"

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

/* The bound of all walks there are. */
double bound_of_all(const Search *s)
{
    Walk walk = {.length = 1, .trim = {(int)s->task->start_trim}};
    Beginning begun[MOST];
    double bound = 0;
    begin(s, &walk, begun);
    for (int level = 0; level < s->automaton->levels; level++)
        bound = greater(bound, least_seconds(&s->remaining, level, &begun[level], walk.trim[0],
                                             (int)s->task->max_trims - 1));
    return bound;
}

/* The walk itself, and the ways on from it, unless some bound excludes them. */
void find_ways(Search *s, const Entry *entry, int fewest, int most)
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
    s->found++;
    if (walk.length == most) return;
    begin(s, &walk, begun);
    next.closed = 0;
    next.trims++;
    for (int m = a->first[trim]; m < a->first[trim + 1]; m++) {
        next.bound = greater(entry->bound, bound_beyond(s, begun, m, most - next.trims));
        next.step[walk.length - 1] = (unsigned short)(m - a->first[trim]);
        s->found++;
        if (next.bound < s->answer->cost) append(&s->ways, &next);
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

int make_room(Search *s)
{
    const Automaton *a = s->automaton;
    int widest = 1;
    for (int trim = 0; trim < a->trims; trim++) widest = (int)larger(widest, a->first[trim + 1] - a->first[trim] + 1);
    s->frontier.most = MOST_WAITING;
    s->left.most = MOST_LEFT;
    s->ways.most = widest;
    s->stack.most = (long)widest * s->task->max_trims;
    set_scales(s);
    return make_remaining(&s->remaining, a, s->task) && has_room(&s->ways, widest)
        && has_room(&s->stack, s->stack.most) && has_room(&s->frontier, widest);
}

void free_room(Search *s)
{
    free_remaining(&s->remaining);
    free(s->frontier.entries);
    free(s->left.entries);
    free(s->ways.entries);
    free(s->stack.entries);
}
