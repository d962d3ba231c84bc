/* For sanitizer builds only: a driver that is unloaded before the leak check cannot be named by it, so it stays. */
#include "cli.h"

#if defined(__SANITIZE_ADDRESS__)
int dlclose(void *handle);
int dlclose(void *handle)
{
    (void)handle;
    return 0;
}

const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:libVkLayer_khronos_validation\n";
}
#endif
