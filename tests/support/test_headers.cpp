// Nothing: the headers that tests share are precompiled with it (tests/CMakeLists.txt).
