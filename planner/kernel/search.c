/* Which sets of times may be not 0, row by row; then the best walk over all rows. */
#include "curves.c"
#include <stdlib.h>
#include <time.h>

/* Candidates of one set of times, the heading at the end free or bound to a limit. */
static void examine(Row *row, Active *on)
{
    Problem p = {.row = row, .on = on, .last = 1};
    cplx A[MOST + 1] = {0};
    double inverse[MOST + 2] = {0}, rate[MOST + 2] = {0};
    int straight[MOST + 1][2], straights[MOST + 1] = {0}, stretch = 0, next = 0, count = 0;
    for (int k = 0; k < row->trims; k++) {
        A[stretch] += row->D[k];
        if (next >= on->count || on->place[next] != k) continue;
        next++;
        if (fabs(row->rate[k]) > STRAIGHT) {
            A[stretch] -= row->C[k];
            A[++stretch] = row->C[k];
            rate[stretch] = row->rate[k];
            inverse[stretch] = 1 / row->rate[k];
        } else {
            if (straights[stretch] == 2) return;
            straight[stretch][straights[stretch]++] = k;
            count++;
        }
    }
    int last = on->bound_heading ? stretch : -1, doubled = -1;
    if (on->bound_heading && !stretch) return;
    p.rest = row->goal;
    if (last >= 0) { p.last = turned(on->target); p.last_rate = rate[last]; }
    for (int j = 0; j <= stretch; j++) {
        cplx factor = j == last ? p.last : 1;
        if (j == 0 || j == last) {
            p.rest -= factor * A[j];
            for (int i = 0; i < straights[j]; i++) {
                if (p.fixed == 2) return;
                p.fixed_place[p.fixed] = straight[j][i];
                p.fixed_velocity[p.fixed++] = factor * row->W[straight[j][i]];
            }
            continue;
        }
        Stretch *s = &p.stretch[p.free];
        s->A = A[j];
        s->rate = rate[j];
        s->a = inverse[j] - (j < stretch ? inverse[j + 1] : 0);
        s->size = cabs(A[j]);
        s->straight = s->other = -1;
        s->limit = s->a != 0 ? s->size / fabs(s->a) : INFINITY;
        if (straights[j]) {
            s->straight = straight[j][0];
            s->w = row->W[s->straight];
            s->limit = s->speed = cabs(s->w);
        }
        if (straights[j] == 2) {
            if (doubled >= 0) return;
            doubled = p.free;
            s->other = straight[j][1];
            s->w_other = row->W[s->other];
        }
        p.free++;
    }
    int equations = row->tolerance > 0 ? 1 : 2, unknown = p.free + count;
    if (unknown == 1 && equations == 2) { in_line(&p); return; }
    if (unknown < equations) return;
    if (unknown == equations) determined(&p);
    else if (doubled >= 0) { if (p.fixed < 2) given_u(&p, doubled); }
    else if (p.fixed == 2) given_u(&p, -1);
    else all_curves(&p);
}

/* Least seconds in which the given trims cover a distance: all chords in line, the end nearing at one speed. */
static double least_time(const Row *row, const Active *on, double distance)
{
    if (distance <= 0) return 0;
    double fastest = 0, reach = 0;
    for (int i = 0; i < on->count; i++) {
        double speed = row->speed[on->place[i]], rate = fabs(row->rate[on->place[i]]);
        fastest = MAX(fastest, speed);
        reach += speed == 0 ? 0 : rate == 0 ? INFINITY : 2 * speed / rate;
    }
    if (!(reach >= distance)) return INFINITY;
    double low = 0, high = fastest, time = distance / fastest;
    for (int round = 0; round < 5; round++) {
        double u = 0.5 * (low + high), covered = 0, spent = 0;
        for (int i = 0; i < on->count; i++) {
            double speed = row->speed[on->place[i]], rate = fabs(row->rate[on->place[i]]);
            if (!(speed > u)) continue;
            if (rate == 0) { covered = INFINITY; break; }
            double half = acos(u / speed);
            covered += 2 * speed / rate * sin(half);
            spent += 2 * half / rate;
        }
        if (covered >= distance) low = u;
        else {
            high = u;
            time = MAX(time, spent + (distance - covered) / u);
        }
    }
    return time;
}

/* No less than the largest cosine of an angle plus anything between two turns: by the series up to the eighth
 * power, which is nowhere below the cosine. */
static double best_cosine(double angle, double low, double high)
{
    double half = 0.5 * (high - low);
    if (half >= M_PI) return 1.0;
    double beyond = fabs(off_turns(angle + 0.5 * (low + high))) - half;
    if (beyond <= 0) return 1.0;
    double x = beyond * beyond;
    return 1 - x * (1. / 2 - x * (1. / 24 - x * (1. / 720 - x / 40320)));
}

/* Whether the goal is out of reach in the seconds given: in some direction, with the headings that can be
 * turned to in that time, neither the maneuvers nor the coasts lead far enough. */
static int out_of_reach(const Row *row, const Active *on, double seconds)
{
    double low[MOST], high[MOST], now_low = 0, now_high = 0;
    cplx still = 0;
    unsigned mask = 0;
    for (int i = 0; i < on->count; i++) mask |= 1u << on->place[i];
    for (int k = 0; k < row->trims; k++) {
        still += row->D[k];
        low[k] = now_low;
        high[k] = now_high;
        if (!((mask >> k) & 1)) continue;
        now_high = MAX(now_high, row->rate[k] * seconds);
        now_low = MIN(now_low, row->rate[k] * seconds);
    }
    double toward = carg(row->goal - still), there = cabs(row->goal), bearing = there > 0 ? carg(row->goal) : 0;
    static const double aside[] = {0, 0.5, -0.5, 1.1, -1.1, 1.8, -1.8};
    for (int way = 0; way < 7; way++) {
        double direction = toward + aside[way], fastest = 0;
        double wanted = there * cos(bearing - direction) - MAX(row->tolerance, 2e-7) - 1e-9;
        for (int k = 0; k < row->trims; k++) {
            wanted -= row->size_D[k] * best_cosine(row->bearing_D[k] - direction, low[k], high[k]);
            if (!((mask >> k) & 1)) continue;
            double turn = row->rate[k] * seconds;
            double speed = row->speed[k]
                * best_cosine(row->bearing_W[k] - direction, MIN(low[k], turn), MAX(high[k], turn));
            fastest = MAX(fastest, speed);
        }
        if (wanted > fastest * seconds) return 1;
    }
    return 0;
}

static double to_cover(const Row *row)
{
    double distance = cabs(row->goal) - MAX(row->tolerance, 2e-7);
    for (int k = 0; k < row->trims; k++) distance -= row->size_D[k];
    return distance;
}

static void choose(const Row *row, Active *on, unsigned mask)
{
    on->count = on->turns = on->slow = 0;
    for (int k = 0; k < row->trims; k++) {
        if (!((mask >> k) & 1)) continue;
        double rate = fabs(row->rate[k]);
        on->place[on->count++] = k;
        on->turns += rate > STRAIGHT;
        on->slow |= rate > 0 && rate <= STRAIGHT;
    }
}

static void both_headings(Row *row, Active *on)
{
    on->bound_heading = 0;
    if (!row->wants_heading || row->heading_tolerance > 0) examine(row, on);
    else if (!on->turns) examine(row, on);
    if (!row->wants_heading || !on->turns) return;
    on->bound_heading = 1;
    for (int side = -1; side <= 1; side += 2) {
        on->target = row->heading + side * row->heading_tolerance;
        if (on->count == 1 && row->tolerance > 0) {
            double rate = row->rate[on->place[0]], angle = remainder(on->target, 2 * M_PI);
            double times[MOST] = {0}, time = angle / rate;
            times[on->place[0]] = time < 0 ? time + 2 * M_PI / fabs(rate) : time;
            keep(row, times);
        }
        examine(row, on);
        if (row->heading_tolerance == 0) break;
    }
}

/* Whether a set of times has more straight coasts than `examine` has equations for: three between two turns (or
 * before the first), twice two between turns, or more than two stretches between turns with one. */
static int too_straight(const Row *row, unsigned mask)
{
    int here = 0, first = 1, doubled = 0, stretches = 0;
    for (int k = 0; k < row->trims; k++) {
        if (!((mask >> k) & 1)) continue;
        if (fabs(row->rate[k]) > STRAIGHT) { here = 0; first = 0; continue; }
        here++;
        if (here > 2) return 1;
        if (!first) { stretches += here == 1; doubled += here == 2; }
    }
    return stretches > 2 || doubled > 1;
}

/* Which sets of times need no look: 1 for those that cannot beat the best so far, as then nothing can that is
 * left of them without one of the times; 2 for those with too many straight coasts. */
static void exclude(const Row *row, unsigned useful, double distance, char *out)
{
    for (unsigned mask = useful; mask; mask = (mask - 1) & useful) {
        Active on;
        out[mask] = 0;
        for (unsigned rest = useful & ~mask; rest && !out[mask]; rest &= rest - 1)
            out[mask] = out[mask | (rest & -rest)] == 1;
        if (out[mask]) continue;
        if (!row->wants_heading && too_straight(row, mask)) { out[mask] = 2; continue; }
        choose(row, &on, mask);
        out[mask] = row->fixed + least_time(row, &on, distance) >= row->best
            || out_of_reach(row, &on, row->best - row->fixed);
    }
}

/* The best times of a row, with at least and at most so many that are not 0. */
static void solve(Row *row, int fewest, int most)
{
    double distance = to_cover(row);
    unsigned useful = 0;
    Active all;
    choose(row, &all, (1u << row->trims) - 1);
    if (row->best < INFINITY && out_of_reach(row, &all, row->best - row->fixed)) return;
    for (int k = 0; k < row->trims; k++)
        if (row->W[k] != 0 || row->rate[k] != 0) useful |= 1u << k;
    if (fewest == 0) {
        double nothing[MOST] = {0};
        keep(row, nothing);
    }
    char out[1 << MOST];
    double known = INFINITY;
    int every = most >= row->trims && row->best < INFINITY;
    if (every) {
        exclude(row, useful, distance, out);
        known = row->best;
    }
    for (int size = fewest > 0 ? fewest : 1; size <= most && size <= row->trims; size++)
        for (unsigned mask = 1; mask < 1u << row->trims; mask++) {
            if ((mask & ~useful) || __builtin_popcount(mask) != size || (every && out[mask])) continue;
            Active on;
            choose(row, &on, mask);
            if (row->best < known) {
                if (row->fixed + least_time(row, &on, distance) >= row->best) continue;
                if (row->best < INFINITY && out_of_reach(row, &on, row->best - row->fixed)) continue;
            }
            both_headings(row, &on);
        }
}

typedef struct {
    const double *rate;
    const cplx *W, *C, *D;
    const double *bearing_D, *bearing_W, *size_D, *speed, *fixed, *turned;
    int trims, walks;
} Table;

typedef struct {
    double goal_north, goal_east, tolerance, heading, heading_tolerance, seconds;
    long wants_heading, levels, tables, most_nodes;
} Task;

typedef struct {
    double cost, bound, least, times[MOST * MOST], costs[MOST];
    long table, walk, nodes, complete;
} Answer;

#define SHORT 4           /* trims */

typedef struct { double bound; int table, walk; } Entry;

static int by_bound(const void *one, const void *other)
{
    const Entry *a = one, *b = other;
    if (a->bound != b->bound) return a->bound < b->bound ? -1 : 1;
    if (a->table != b->table) return a->table - b->table;
    return a->walk - b->walk;
}

static void load(Row *row, const Task *task, const Table *table, long index)
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
    row->wants_heading = (int)task->wants_heading;
    row->heading = task->heading - table->turned[index];
    row->heading_tolerance = task->heading_tolerance;
}

static double bound_of(const Row *row)
{
    Active on;
    choose(row, &on, (1u << row->trims) - 1);
    if (row->wants_heading && fabs(off_turns(row->heading)) > MAX(row->heading_tolerance, 1e-6)) {
        int turns = 0;
        for (int k = 0; k < row->trims; k++) turns |= row->rate[k] != 0;
        if (!turns) return INFINITY;
    }
    return row->fixed + least_time(row, &on, to_cover(row));
}

/* Solves a walk at every level, the one with the largest bound first; keeps it if its worst level is best. */
static void try_walk(const Task *task, const Table *tables, const Entry *entry, int fewest, int most, Answer *answer)
{
    int levels = (int)task->levels;
    double bounds[MOST], costs[MOST], times[MOST * MOST], worst = 0;
    Row row;
    for (int level = 0; level < levels; level++) {
        load(&row, task, &tables[entry->table], (long)entry->walk * levels + level);
        bounds[level] = bound_of(&row);
    }
    for (int done = 0; done < levels; done++) {
        int level = 0;
        for (int other = 1; other < levels; other++) if (bounds[other] > bounds[level]) level = other;
        bounds[level] = -1;
        load(&row, task, &tables[entry->table], (long)entry->walk * levels + level);
        row.best = answer->cost;
        answer->nodes++;
        solve(&row, fewest, most);
        if (!(row.best < answer->cost)) return;
        costs[level] = row.best;
        worst = MAX(worst, row.best);
        memcpy(times + level * MOST, row.times, sizeof(row.times));
    }
    answer->cost = worst;
    answer->table = entry->table;
    answer->walk = entry->walk;
    memcpy(answer->costs, costs, sizeof(costs));
    memcpy(answer->times, times, sizeof(times));
}

static double clock_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Whether the nodes or the seconds allowed are used up. */
static int over(const Task *task, const Answer *answer, double began)
{
    return answer->nodes >= task->most_nodes || (task->seconds < INFINITY && clock_now() - began >= task->seconds);
}

/* The walk whose worst level is best: first with as many times as equations everywhere, for a good plan soon,
 * then with every set of times; at last the winner once more at the levels that do not decide. */
int search(const Task *task, const Table *tables, Answer *answer)
{
    double began = clock_now();
    long total = 0, used = 0;
    for (int t = 0; t < task->tables; t++) total += tables[t].walks;
    Entry *entries = malloc(sizeof(Entry) * (size_t)(total ? total : 1));
    if (!entries) return 1;
    answer->cost = answer->bound = INFINITY;
    answer->table = answer->walk = -1;
    answer->nodes = 0;
    answer->complete = 1;
    for (int t = 0; t < task->tables; t++)
        for (int w = 0; w < tables[t].walks; w++) {
            double bound = 0;
            Row row;
            for (int level = 0; level < task->levels; level++) {
                load(&row, task, &tables[t], (long)w * task->levels + level);
                bound = MAX(bound, bound_of(&row));
            }
            if (bound < INFINITY) entries[used++] = (Entry){bound, t, w};
        }
    answer->least = INFINITY;
    for (long i = 0; i < used; i++) answer->least = MIN(answer->least, entries[i].bound);
    qsort(entries, (size_t)used, sizeof(Entry), by_bound);
    /* Closed forms aim at the middle of the tolerance. */
    Task middle = *task;
    middle.tolerance = 0;
    int equations = 2 + (task->wants_heading ? 1 : 0);
    /* Short walks first: they soon give a plan that excludes most of the long ones. */
    for (int longer = 0; longer < 2; longer++)
        for (long i = 0; i < used && answer->complete; i++) {
            if (entries[i].bound >= answer->cost) break;
            if ((tables[entries[i].table].trims > SHORT) != longer) continue;
            if (over(task, answer, began)) { answer->complete = 0; answer->bound = entries[0].bound; }
            else {
                double before = answer->cost;
                try_walk(&middle, tables, &entries[i], 0, equations, answer);
                /* A walk that has become the best is worth solving to the end at once. */
                if (answer->cost < before) try_walk(task, tables, &entries[i], 0, MOST, answer);
            }
        }
    for (long i = 0; i < used && answer->complete; i++) {
        if (entries[i].bound >= answer->cost) break;
        if (over(task, answer, began)) { answer->complete = 0; answer->bound = entries[i].bound; }
        else try_walk(task, tables, &entries[i], 0, MOST, answer);
    }
    for (int level = 0; answer->walk >= 0 && level < task->levels; level++) {
        Row row;
        load(&row, task, &tables[answer->table], answer->walk * task->levels + level);
        row.best = answer->costs[level];
        memcpy(row.times, answer->times + level * MOST, sizeof(row.times));
        solve(&row, 0, MOST);
        answer->costs[level] = row.best;
        memcpy(answer->times + level * MOST, row.times, sizeof(row.times));
    }
    if (answer->complete || answer->bound > answer->cost) answer->bound = answer->cost;
    free(entries);
    return 0;
}

/* The least cost of every row on its own; infinite where it does not reach the goal. */
void each(const Task *task, const Table *table, double *costs)
{
    for (long index = 0; index < table->walks; index++) {
        Row row;
        load(&row, task, table, index);
        row.best = INFINITY;
        solve(&row, 0, MOST);
        costs[index] = row.best;
    }
}
