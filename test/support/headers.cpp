// Nothing: a target needs a source, also one for precompiled headers alone (test/CMakeLists.txt).
