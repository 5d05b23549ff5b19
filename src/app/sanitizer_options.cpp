/// Options of the program with sanitizers. LeakSanitizer must not look into thread-local blocks of libraries that were
/// loaded and closed, as plugins are: where their place is used again it reads what is no block, and crashes.

// The name is AddressSanitizer's.
// NOLINTBEGIN(bugprone-reserved-identifier)
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() { return "intercept_tls_get_addr=0"; }
// NOLINTEND(bugprone-reserved-identifier)
