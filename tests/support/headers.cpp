// Empty source for the precompiled headers of the tests (tests/CMakeLists.txt).
