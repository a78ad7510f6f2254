/* The best walk over all rows. */
#include "kernel.h"
#include <stdlib.h>
#include <time.h>

typedef struct {
    const double *rate;
    const cplx *W, *C, *D;
    const double *bearing_D, *bearing_W, *size_D, *speed, *fixed, *turned;
    int trims, walks;
} Table;

typedef struct {
    double goal_north, goal_east, tolerance, slack, heading, heading_tolerance, heading_slack, seconds;
    long wants_heading, levels, tables, most_nodes;
} Task;

typedef struct {
    double cost, bound, least, times[MOST * MOST], costs[MOST];
    long table, walk, nodes, complete;
} Answer;

#define SHORT 4           /* trims */
#define NEAR_THE_EDGE 0.999 /* of the tolerance: where closed forms aim */

typedef struct { double bound; int table, walk, open; } Entry;

typedef struct {
    const Task *task;
    const Table *tables;
    Answer *answer;
    double began;             /* s */
    cplx worth[MOST];         /* s/m; at each level, a multiplier that was good for the walk before */
} Search;

static int by_bound(const void *one, const void *other)
{
    const Entry *a = one, *b = other;
    if (a->bound != b->bound) return a->bound < b->bound ? -1 : 1;
    if (a->table != b->table) return a->table - b->table;
    return a->walk - b->walk;
}

/* Against the goal, at 5 m/s. */
static cplx first_worth(cplx goal) { return cabs(goal) > 0 ? -0.2 * goal / cabs(goal) : -0.2; }

static void load(Problem *row, const Task *task, const Table *table, long index)
{
    long at = index * table->trims;
    row->trims = table->trims;
    row->rate = table->rate + at;
    row->W = table->W + at;
    row->C = table->C + at;
    row->D = table->D + at;
    row->bearing_D = table->bearing_D + at;
    row->bearing_W = table->bearing_W + at;
    row->size_D = table->size_D + at;
    row->speed = table->speed + at;
    row->fixed = table->fixed[index];
    row->goal = task->goal_north + I * task->goal_east;
    row->tolerance = task->tolerance;
    row->slack = task->slack;
    row->heading_slack = task->heading_slack;
    row->wants_heading = (int)task->wants_heading;
    row->heading = task->heading - table->turned[index];
    row->heading_tolerance = task->heading_tolerance;
    row->multiplier = first_worth(row->goal);
    row->straight = row->hardly_bent = 0;
}

/* One walk at every level, in the order in which they are looked at: the one with the largest bound first. */
typedef struct { Problem row[MOST]; int order[MOST]; } Levels;

/* Whether some level cannot beat the best so far. */
static int excluded(Search *s, const Entry *entry, Levels *every)
{
    int levels = (int)s->task->levels;
    double bounds[MOST], best = s->answer->cost;
    for (int level = 0; level < levels; level++) {
        Problem *row = &every->row[level];
        load(row, s->task, &s->tables[entry->table], (long)entry->walk * levels + level);
        bounds[level] = lower_bound(row);
        row->best = best;
        row->multiplier = s->worth[level];
    }
    for (int done = 0; done < levels; done++) {
        int level = 0;
        for (int other = 1; other < levels; other++) if (bounds[other] > bounds[level]) level = other;
        if (bounds[level] >= best) return 1;
        bounds[level] = -1;
        every->order[done] = level;
        Problem *row = &every->row[level];
        s->answer->nodes++;
        if (best == INFINITY) continue;
        int out = cannot_beat(row);
        s->worth[level] = row->multiplier;
        if (out) return 1;
    }
    return 0;
}

/* Solves a walk at every level; keeps it if its worst level is best. With a limit, no more times are not 0, and the
 * goal is the point where the tolerance is used up best. Returns whether it was kept. */
static int solved(Search *s, const Entry *entry, const Levels *every, int most)
{
    int levels = (int)s->task->levels;
    double costs[MOST], times[MOST * MOST], worst = 0;
    for (int done = 0; done < levels; done++) {
        int level = every->order[done];
        Problem row = every->row[level];
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
    s->answer->table = entry->table;
    s->answer->walk = entry->walk;
    memcpy(s->answer->costs, costs, sizeof(costs));
    memcpy(s->answer->times, times, sizeof(times));
    return 1;
}

static double clock_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Whether the nodes or the seconds allowed are used up. */
static int over(const Search *s)
{
    const Task *task = s->task;
    return s->answer->nodes >= task->most_nodes
        || (task->seconds < INFINITY && clock_now() - s->began >= task->seconds);
}

/* All walks that some bound does not exclude, by bound. */
static long list(const Task *task, const Table *tables, Entry *entries)
{
    long used = 0;
    for (int t = 0; t < task->tables; t++)
        for (int w = 0; w < tables[t].walks; w++) {
            double bound = 0;
            Problem row;
            for (int level = 0; level < task->levels; level++) {
                load(&row, task, &tables[t], (long)w * task->levels + level);
                bound = greater(bound, lower_bound(&row));
            }
            if (bound < INFINITY) entries[used++] = (Entry){bound, t, w, 1};
        }
    qsort(entries, (size_t)used, sizeof(Entry), by_bound);
    return used;
}

/* Looks for a good plan soon: with as many times as equations only, short walks first, which soon give a plan that
 * excludes most of the long ones. A walk that has become the best is solved to the end at once. */
static void dive(Search *s, Entry *entries, long used)
{
    Levels every;
    int equations = 2 + (s->task->wants_heading ? 1 : 0);
    for (int longer = 0; longer < 2; longer++)
        for (long i = 0; i < used; i++) {
            Entry *one = &entries[i];
            if (one->bound >= s->answer->cost) break;
            if (!one->open || (s->tables[one->table].trims > SHORT) != longer) continue;
            if (over(s)) { s->answer->complete = 0; s->answer->bound = s->answer->least; return; }
            if (excluded(s, one, &every)) one->open = 0;
            else if (solved(s, one, &every, equations)) { solved(s, one, &every, MOST); one->open = 0; }
        }
}

/* Solves what is left, with every set of times. */
static void finish(Search *s, Entry *entries, long used)
{
    Levels every;
    for (long i = 0; i < used; i++) {
        Entry *one = &entries[i];
        if (one->bound >= s->answer->cost) break;
        if (!one->open) continue;
        if (over(s)) { s->answer->complete = 0; s->answer->bound = one->bound; return; }
        if (!excluded(s, one, &every)) solved(s, one, &every, MOST);
    }
}

/* The winner once more at the levels that do not decide. */
static void polish(const Task *task, const Table *tables, Answer *answer)
{
    for (int level = 0; answer->walk >= 0 && level < task->levels; level++) {
        Problem row;
        load(&row, task, &tables[answer->table], answer->walk * task->levels + level);
        row.best = answer->costs[level];
        memcpy(row.times, answer->times + level * MOST, sizeof(row.times));
        solve(&row, MOST);
        answer->costs[level] = row.best;
        memcpy(answer->times + level * MOST, row.times, sizeof(row.times));
    }
}

/* The walk whose worst level is best. */
PUBLIC int search(const Task *task, const Table *tables, Answer *answer)
{
    Search s = {.task = task, .tables = tables, .answer = answer, .began = clock_now()};
    long total = 0;
    for (int t = 0; t < task->tables; t++) total += tables[t].walks;
    Entry *entries = malloc(sizeof(Entry) * (size_t)(total ? total : 1));
    if (!entries) return 1;
    long used = list(task, tables, entries);
    answer->cost = answer->bound = INFINITY;
    answer->least = used ? entries[0].bound : INFINITY;
    answer->table = answer->walk = -1;
    answer->nodes = 0;
    answer->complete = 1;
    for (int level = 0; level < task->levels; level++) s.worth[level] = first_worth(task->goal_north + I * task->goal_east);
    dive(&s, entries, used);
    if (answer->complete) finish(&s, entries, used);
    polish(task, tables, answer);
    if (answer->complete || answer->bound > answer->cost) answer->bound = answer->cost;
    free(entries);
    return 0;
}

/* The least cost of every row on its own, infinite where it does not reach the goal, and its times. */
PUBLIC void each(const Task *task, const Table *table, double *costs, double *times)
{
    for (long index = 0; index < table->walks; index++) {
        Problem row;
        load(&row, task, table, index);
        row.best = INFINITY;
        solve(&row, MOST);
        costs[index] = row.best;
        if (row.best < INFINITY) memcpy(times + index * row.trims, row.times, sizeof(double) * (size_t)row.trims);
    }
}
