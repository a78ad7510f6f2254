/* Hash table of active sets that several walks have in common.
 *
 * Where maneuvers cost nothing, or different maneuvers lead to the same place, many walks have the same trims with the
 * same displacements between: their active sets are one problem. Its key is a hash of 128 bits of the coefficients,
 * rounded to a step.
 */
#include "coasting.h"
#include <stdlib.h>

/* Allocates a table for a power of 2 of active sets, with coefficients rounded to a share of length, speed and a
 * radian; 0 without memory. With once, each set is solved only once, whatever the incumbent is then. */
SetCache *make_set_cache(long capacity, double share, double way, double speed, int once)
{
    SetCache *cache = malloc(sizeof(SetCache));
    if (!cache) return 0;
    *cache = (SetCache){.capacity = capacity, .angle_step = share, .once = once};
    cache->length_step = share * (way > 0 ? way : 1);
    cache->speed_step = share * (speed > 0 ? speed : 1);
    cache->sets = calloc((size_t)capacity, sizeof(CachedSet));
    if (cache->sets) return cache;
    free(cache);
    return 0;
}

void free_set_cache(SetCache *cache)
{
    if (cache) free(cache->sets);
    free(cache);
}

static void mix(uint64_t *hash, uint64_t value)
{
    hash[0] = (hash[0] ^ value) * 0x9E3779B97F4A7C15u;
    hash[0] ^= hash[0] >> 29;
    hash[1] = (hash[1] + value) * 0xD6E8FEB86659FD93u;
    hash[1] ^= hash[1] >> 32;
}

static void mix_number(uint64_t *hash, double value, double unit)
{
    mix(hash, (uint64_t)(int64_t)rint(value / unit));
}

static void mix_vector(uint64_t *hash, cplx value, double unit)
{
    mix_number(hash, creal(value), unit);
    mix_number(hash, cimag(value), unit);
}

/* Hashes the parts of a walk. */
void hash_walk(WalkHash *walk_hash, const Problem *p, const SetCache *cache)
{
    cplx before = 0;
    memset(walk_hash->coast, 0, sizeof(walk_hash->coast));
    for (int k = 0; k < p->trims; k++) {
        uint64_t rate;
        memcpy(&rate, &p->rate[k], sizeof(rate));
        walk_hash->before[k] = before += p->D[k];
        mix(walk_hash->coast[k], rate);
        mix_vector(walk_hash->coast[k], p->W[k], cache->speed_step);
    }
    walk_hash->end[0] = walk_hash->end[1] = 1;
    mix_vector(walk_hash->end, before, cache->length_step);
    if (p->wants_heading) mix_number(walk_hash->end, off_turns(p->heading), cache->angle_step);
}

/* Finds or inserts an active set; 0 where the table is full. */
CachedSet *cached_set(SetCache *cache, const WalkHash *walk_hash, unsigned mask)
{
    uint64_t hash[2] = {walk_hash->end[0], walk_hash->end[1]};
    for (unsigned rest = mask; rest; rest &= rest - 1) {
        int k = __builtin_ctz(rest);
        mix(hash, walk_hash->coast[k][0]);
        mix(hash, walk_hash->coast[k][1]);
        mix_vector(hash, walk_hash->before[k], cache->length_step);
    }
    hash[0] |= 1;
    for (long at = (long)(hash[1] & (uint64_t)(cache->capacity - 1));; at = (at + 1) & (cache->capacity - 1)) {
        CachedSet *set = &cache->sets[at];
        if (set->hash[0] == hash[0] && set->hash[1] == hash[1]) return set;
        if (set->hash[0]) continue;
        if (2 * cache->count > cache->capacity) return 0;
        memcpy(set->hash, hash, sizeof(hash));
        cache->count++;
        return set;
    }
}
