/* Under the address sanitizer, which takes ten times as long, a test may look at less: at so much that all of its lines
 * run. What numbers come to is looked at as released. */
#pragma once

#ifdef __SANITIZE_ADDRESS__
enum { IS_SANITIZED = 1 };
#else
enum { IS_SANITIZED = 0 };
#endif
