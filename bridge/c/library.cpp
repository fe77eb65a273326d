#include "bridge/c/guard.h"

#include <cstdlib>

using namespace supercircle::c;

int32_t sc_api_version(void) {
    return SC_API_VERSION;
}

const char* sc_version(void) {
    return SC_VERSION;
}

const char* sc_error(void) {
    return lastError();
}

sc_status sc_error_status(void) {
    return lastStatus();
}

void* sc_alloc(int32_t bytes) {
    void* memory = nullptr;
    (void)shielded([&] {
        if (bytes < 0)
            refuse(SC_BAD_INPUT, "a negative number of bytes");
        memory = std::malloc(bytes > 0 ? static_cast<std::size_t>(bytes) : 1);
        if (memory == nullptr)
            throw std::bad_alloc();
    });
    return memory;
}

void sc_free(void* memory) {
    std::free(memory);
}
