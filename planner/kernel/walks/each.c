/* Best coasting times of many walks, each on its own. */
#include "walks.h"

typedef struct {
    const double *rate;
    const cplx *W, *C, *D;
    const double *bearing_D, *bearing_W, *size_D, *speed, *fixed, *turned;
    int trims, walks;
} Table;

static void load(Problem *row, const Task *task, const Table *table, long index)
{
    long at = index * table->trims;
    set_task(row, task);
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
    row->heading = task->heading - table->turned[index];
    row->multiplier = first_multiplier(row->goal);
}

/* Solves every walk on its own: its least cost, infinite where the goal is out of reach, and its times. */
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
