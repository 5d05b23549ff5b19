// Nothing: its target holds the headers that are precompiled for all tests.
