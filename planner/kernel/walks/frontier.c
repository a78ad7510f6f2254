/* Priority queue of nodes, a heap with four children, least lower bound first. */
#include "walks.h"

#define FIRST_CAPACITY 1024 /* entries allocated at first */

/* Orders by bound; then inner nodes before leaves, short prefixes before long ones, and by the library's order. */
static int before(const Node *one, const Node *other)
{
    if (one->bound != other->bound) return one->bound < other->bound;
    if (one->leaf != other->leaf) return one->leaf < other->leaf;
    if (one->trims != other->trims) return one->trims < other->trims;
    int k = 0;
    while (k < one->trims - 2 && one->step[k] == other->step[k]) k++;
    return one->step[k] < other->step[k];
}

int in_order(const void *one, const void *other)
{
    return before(one, other) ? -1 : before(other, one);
}

/* Reserves space for more nodes; returns 0 where the limit or the memory is exhausted. */
int reserve(Frontier *f, long more)
{
    if (f->count + more <= f->capacity) return 1;
    if (f->count + more > f->most) return 0;
    long capacity = smaller(larger(f->count + more, larger(2 * f->capacity, FIRST_CAPACITY)), f->most);
    Node *entries = realloc(f->entries, sizeof(Node) * (size_t)capacity);
    if (!entries) return 0;
    f->entries = entries;
    f->capacity = capacity;
    return 1;
}

void append(Frontier *f, const Node *entry) { f->entries[f->count++] = *entry; }

void push(Frontier *f, const Node *entry)
{
    long place = f->count++;
    while (place > 0) {
        long parent = (place - 1) / 4;
        if (!before(entry, &f->entries[parent])) break;
        f->entries[place] = f->entries[parent];
        place = parent;
    }
    f->entries[place] = *entry;
}

Node pop(Frontier *f)
{
    Node first = f->entries[0], last = f->entries[--f->count];
    long place = 0;
    for (;;) {
        long best = 4 * place + 1;
        if (best >= f->count) break;
        for (long child = best + 1; child < 4 * place + 5 && child < f->count; child++)
            if (before(&f->entries[child], &f->entries[best])) best = child;
        if (!before(&f->entries[best], &last)) break;
        f->entries[place] = f->entries[best];
        place = best;
    }
    f->entries[place] = last;
    return first;
}
