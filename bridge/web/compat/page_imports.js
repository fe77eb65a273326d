// Calls that a page gives to supercircle_lab.wasm (loader/lab_calls.cpp). Named here, so that the linker refuses any other
// symbol that is missing.
mergeInto(LibraryManager.library, { progress: () => 0 });
