// Empty source for the precompiled headers of all libraries (Modules.cmake).
