/* Counts the calls of every function that is compiled with -finstrument-functions. */
#define UNSEEN __attribute__((no_instrument_function))
#define OURS __attribute__((visibility("hidden"))) /* the C library has the same */
#define ROOM 1024

static struct { void *function; long count; } table[ROOM];

static UNSEEN long *count_of(void *function)
{
    unsigned long place = ((unsigned long)function >> 2) % ROOM;
    while (table[place].function && table[place].function != function) place = (place + 1) % ROOM;
    table[place].function = function;
    return &table[place].count;
}

UNSEEN OURS void __cyg_profile_func_enter(void *function, void *site)
{
    (void)site;
    ++*count_of(function);
}

UNSEEN OURS void __cyg_profile_func_exit(void *function, void *site)
{
    (void)function;
    (void)site;
}

UNSEEN long calls_of(void *function) { return *count_of(function); }

UNSEEN void forget_calls(void)
{
    for (int place = 0; place < ROOM; place++) table[place].count = 0;
}
