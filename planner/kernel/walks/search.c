/* Branch and bound over walks, in two passes.
 *
 * The first pass takes walks best first and solves closed forms only, which soon gives an incumbent that prunes most
 * of the others. The second pass solves what is left, with every active set.
 */
#include "walks.h"

#define FIRST_DEPTH 4     /* trims; longer walks are searched once these are */
#define BRANCHES_PER_NODE 1000 /* children that cost about as much as a solved walk */
#define COARSE_STEP 1e-3  /* of length, speed and rad: rounding of coefficients in the first pass ... */
#define FINE_STEP 1e-12   /* ... and in the second */

#define FIRST_CACHE (1 << 17) /* active sets, 5 MB ... */
#define SECOND_CACHE (1 << 19) /* ... and 20 MB; similar_sets.c has 52 MB */

/* Whether the nodes or the seconds allowed are used up. */
static int limit_reached(const Search *s)
{
    long nodes = s->answer->nodes + s->branched / BRANCHES_PER_NODE;
    return nodes >= s->task->most_nodes || past_deadline(s->second_pass.deadline);
}

/* Visits a leaf in the first pass. A walk that improves the incumbent is solved completely at once; others are
 * deferred. Returns 0 after the deadline. */
static int visit(Search *s, const Node *walk)
{
    Levels every;
    int equations = 2 + (s->task->wants_heading ? 1 : 0);
    if (++s->examined == MANY_WALKS)
        s->first_pass.cache = make_set_cache(FIRST_CACHE, COARSE_STEP, s->length_scale, s->speed_scale, 1);
    if (pruned_by_bounds(s, walk, &every)) return 1;
    int hopeful = s->examined - s->improved_at <= larger(PATIENCE, s->improved_at);
    int kept = hopeful && improves_incumbent(s, &every, equations);
    if (kept) s->improved_at = s->examined;
    if (kept || !reserve(&s->deferred, 1)) improves_incumbent(s, &every, MOST);
    else append(&s->deferred, walk);
    return !past_deadline(s->second_pass.deadline);
}

/* Stops the search with the least lower bound of the open nodes, the deferred walks and the longer walks. */
static void stop_search(Search *s, double bound, int most)
{
    s->answer->complete = 0;
    if (most < s->task->max_trims) bound = lesser(bound, root_bound(s));
    for (long i = 0; i < s->deferred.count; i++) bound = lesser(bound, s->deferred.entries[i].bound);
    s->answer->bound = bound;
}

/* Depth-first search below a node, in constant memory. */
static void depth_first(Search *s, const Node *first, int fewest, int most)
{
    Frontier *stack = &s->stack, *branches = &s->branches;
    stack->count = 0;
    append(stack, first);
    while (stack->count) {
        Node one = stack->entries[--stack->count];
        if (one.bound >= s->answer->cost) continue;
        if (limit_reached(s) || (one.leaf && !visit(s, &one))) { stop_search(s, first->bound, most); return; }
        if (one.leaf) continue;
        branch(s, &one, fewest, most);
        qsort(branches->entries, (size_t)branches->count, sizeof(Node), in_order);
        while (branches->count) append(stack, &branches->entries[--branches->count]);
    }
}

/* Best-first search over walks of some lengths. */
static void best_first(Search *s, int fewest, int most)
{
    Frontier *f = &s->frontier;
    Node first = {.trims = 1};
    f->count = 0;
    push(f, &first);
    while (f->count && s->answer->complete) {
        Node one = pop(f);
        if (one.bound >= s->answer->cost) break;
        if (limit_reached(s) || (one.leaf && !visit(s, &one))) { stop_search(s, one.bound, most); return; }
        if (one.leaf) continue;
        if (!reserve(f, s->branches.capacity)) depth_first(s, &one, fewest, most);
        else {
            branch(s, &one, fewest, most);
            for (long i = 0; i < s->branches.count; i++) push(f, &s->branches.entries[i]);
        }
    }
}

/* The second pass. */
static void solve_deferred(Search *s)
{
    Levels every;
    if (s->deferred.count > MANY_WALKS) {
        s->second_pass.cache = make_set_cache(SECOND_CACHE, FINE_STEP, s->length_scale, s->speed_scale, 0);
        s->second_pass.similar = make_similar_sets(s->length_scale, s->speed_scale);
    }
    qsort(s->deferred.entries, (size_t)s->deferred.count, sizeof(Node), in_order);
    for (long i = 0; i < s->deferred.count; i++) {
        Node *one = &s->deferred.entries[i];
        if (one->bound >= s->answer->cost) break;
        int stopped = limit_reached(s);
        if (!stopped && !pruned_by_bounds(s, one, &every)) improves_incumbent(s, &every, MOST);
        if (stopped || past_deadline(s->second_pass.deadline)) {
            s->answer->complete = 0;
            s->answer->bound = one->bound;
            return;
        }
    }
}

/* Finds the walk with the fastest worst level; returns 1 without memory. */
PUBLIC int search(const Task *task, const Automaton *automaton, Answer *answer)
{
    Search s = {.task = task, .automaton = automaton, .answer = answer};
    s.second_pass.deadline = s.first_pass.deadline = task->seconds < INFINITY ? clock_now() + task->seconds : INFINITY;
    answer->cost = INFINITY;
    answer->trims = answer->nodes = 0;
    answer->complete = 1;
    int made = allocate(&s), most = (int)task->max_trims;
    if (made) {
        for (int level = 0; level < automaton->levels; level++)
            s.multiplier[level] = first_multiplier(task->goal_north + I * task->goal_east);
        best_first(&s, 1, (int)smaller(FIRST_DEPTH, most));
        if (answer->complete && most > FIRST_DEPTH) best_first(&s, FIRST_DEPTH + 1, most);
        if (answer->complete) solve_deferred(&s);
        polish(&s);
        if (answer->complete || answer->bound > answer->cost) answer->bound = answer->cost;
    }
    release(&s);
    free_set_cache(s.first_pass.cache);
    free_set_cache(s.second_pass.cache);
    free_similar_sets(s.second_pass.similar);
    return !made;
}
