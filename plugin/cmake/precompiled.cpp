// Carries the precompiled headers of all libraries (Modules.cmake); it has nothing of its own.
