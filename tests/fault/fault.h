/* Makes every RIS_VK call of `run` fail in turn: n = 0, 1, 2 ... until n is beyond the last call. Each
 * failure must give `expected` and a sentence that names the call and `what`; run must free all it made. */
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <string.h>

#include "vk/vk.h"

static inline void fail_each_call(ris_result (*run)(ris_error *), VkResult what, ris_result expected,
                                  uint32_t at_least)
{
    int64_t n = 0;
    for (;; n++) {
        ris_error err = {0};
        ris_result result;
        ris__vk_fault_set(n, what);
        result = run(&err);
        if (ris__vk_fault_count() <= n) {
            assert_int_equal(result, RIS_OK); /* n was beyond the last call */
            break;
        }
        if (result != expected || err.code != expected || !strstr(err.text, ris_vk_result_name(what)) ||
            !strstr(err.text, "vk")) {
            fail_msg("call %lld failed with %s, but the result is %d, expected %d: \"%s\"", (long long)n,
                     ris_vk_result_name(what), (int)result, (int)expected, err.text);
        }
    }
    ris__vk_fault_set(-1, VK_SUCCESS);
    print_message("%lld calls failed in turn\n", (long long)n);
    assert_true(n >= (int64_t)at_least);
}
