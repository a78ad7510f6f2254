/* Children of a node of the search tree, with their lower bounds. */
#include "walks.h"

/* Lower bound of a walk: that of its worst level. */
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

/* Sums up a prefix at every level. */
static void measure_prefix(const Search *s, const Walk *walk, Prefix *prefix)
{
    const Automaton *a = s->automaton;
    int maneuvers = a->first[a->trims];
    double distance = cabs(s->task->goal_north + I * s->task->goal_east) - s->task->tolerance - s->task->slack;
    for (int level = 0; level < a->levels; level++) {
        Prefix *one = &prefix[level];
        *one = (Prefix){.distance = distance};
        for (int k = 0; k < walk->length; k++) {
            one->group = (int)larger(one->group, s->remaining.group[level * a->trims + walk->trim[k]]);
            if (!k) continue;
            one->fixed += a->duration[level * maneuvers + walk->maneuver[k]];
            one->distance -= a->size[level * maneuvers + walk->maneuver[k]];
        }
    }
}

/* Lower bound of all walks that continue a prefix with one maneuver. */
static double bound_beyond(const Search *s, const Prefix *prefix, int maneuver, int left)
{
    const Automaton *a = s->automaton;
    double bound = 0;
    for (int level = 0; level < a->levels; level++) {
        int at = level * a->first[a->trims] + maneuver, group = s->remaining.group[level * a->trims + a->to[maneuver]];
        Prefix one = {prefix[level].fixed + a->duration[at], prefix[level].distance - a->size[at],
                     (int)larger(prefix[level].group, group)};
        bound = greater(bound, least_seconds(&s->remaining, level, &one, a->to[maneuver], left));
    }
    return bound;
}

/* Lower bound of all walks. */
double root_bound(const Search *s)
{
    Walk walk = {.length = 1, .trim = {(int)s->task->start_trim}};
    Prefix prefix[MOST];
    double bound = 0;
    measure_prefix(s, &walk, prefix);
    for (int level = 0; level < s->automaton->levels; level++)
        bound = greater(bound, least_seconds(&s->remaining, level, &prefix[level], walk.trim[0],
                                             (int)s->task->max_trims - 1));
    return bound;
}

/* Finds the children of a node that the incumbent does not prune: its prefix as a leaf, and one node a maneuver. */
void branch(Search *s, const Node *entry, int fewest, int most)
{
    Walk walk;
    Prefix prefix[MOST];
    const Automaton *a = s->automaton;
    Node next = *entry;
    read_walk(a, s->task, entry, &walk);
    int trim = walk.trim[walk.length - 1];
    s->branches.count = 0;
    if (walk.length >= fewest && (s->task->goal_trim < 0 || trim == s->task->goal_trim)) {
        next.leaf = 1;
        next.bound = bound_of_walk(s, &walk);
        if (next.bound < s->answer->cost) append(&s->branches, &next);
    }
    s->branched++;
    if (walk.length == most) return;
    measure_prefix(s, &walk, prefix);
    next.leaf = 0;
    next.trims++;
    for (int m = a->first[trim]; m < a->first[trim + 1]; m++) {
        next.bound = greater(entry->bound, bound_beyond(s, prefix, m, most - next.trims));
        next.step[walk.length - 1] = (unsigned short)(m - a->first[trim]);
        s->branched++;
        if (next.bound < s->answer->cost) append(&s->branches, &next);
    }
}

/* Sets the scales of length and speed by which small differences are judged. */
static void set_scales(Search *s)
{
    const Automaton *a = s->automaton;
    s->length_scale = cabs(s->task->goal_north + I * s->task->goal_east) + s->task->tolerance;
    for (int m = 0; m < a->levels * a->first[a->trims]; m++) s->length_scale = greater(s->length_scale, a->size[m]);
    for (int trim = 0; trim < a->levels * a->trims; trim++) s->speed_scale = greater(s->speed_scale, a->speed[trim]);
}

int allocate(Search *s)
{
    const Automaton *a = s->automaton;
    int widest = 1;
    for (int trim = 0; trim < a->trims; trim++) widest = (int)larger(widest, a->first[trim + 1] - a->first[trim] + 1);
    s->frontier.most = MOST_QUEUED;
    s->deferred.most = MOST_DEFERRED;
    s->branches.most = widest;
    s->stack.most = (long)widest * s->task->max_trims;
    set_scales(s);
    return make_remaining(&s->remaining, a, s->task) && reserve(&s->branches, widest)
        && reserve(&s->stack, s->stack.most) && reserve(&s->frontier, widest);
}

void release(Search *s)
{
    free_remaining(&s->remaining);
    free(s->frontier.entries);
    free(s->deferred.entries);
    free(s->branches.entries);
    free(s->stack.entries);
}
