// What a person reads of the time left.
#include <support/catch.h>

#include <time_left.h>

TEST_CASE("time left is what the pace says, and what has passed since is taken off") {
    TimeLeft t;
    t.update("march", 0, 100);
    t.update("march", 0.25, 102);
    CHECK(t.left(102) == Approx(6));
    CHECK(t.left(105) == Approx(3));  // no report for 3 s
    CHECK(t.describe(102) == "march 25 %, 6 s left");
    t.update("march", 0.5, 110);  // slower than it looked
    CHECK(t.left(110) == Approx(10));
}

TEST_CASE("what is not known is not printed") {
    TimeLeft t;
    CHECK_FALSE(t.left(0));
    t.update("read", 0, 10);
    CHECK_FALSE(t.left(20));
    CHECK(t.describe(20) == "read, 10 s so far");
    // A first report says little about the pace, and so does one right after the start.
    t.update("march", 0, 20);
    t.update("march", 0.001, 23);
    CHECK_FALSE(t.left(23));
    t.update("picture", 0, 30);
    t.update("picture", 0.3, 30.1);
    CHECK_FALSE(t.left(30.1));
    // More time has passed than it said.
    t.update("mesh", 0, 40);
    t.update("mesh", 0.5, 42);
    CHECK(t.left(43) == Approx(1));
    CHECK_FALSE(t.left(45));
    CHECK(t.describe(45) == "mesh 50 %, 5 s so far");
    t.update("mesh", 1, 46);
    CHECK_FALSE(t.left(46));
}

TEST_CASE("a steady stage never promises less and then much more") {
    TimeLeft t;
    double last = 1e9;
    for (int k = 0; k <= 1000; ++k) {
        const double now = 0.1 * k;
        t.update("march", 0.001 * k, now);
        if (const auto left = t.left(now)) {
            CHECK(*left == Approx(100 - now));
            CHECK(*left < last);
            last = *left;
        }
    }
    CHECK(last < 1);
}

TEST_CASE("a stage that begins again has a clock of its own; late reports change nothing") {
    TimeLeft t;
    t.update("march", 0, 0);
    t.update("march", 0.9, 9);
    t.update("march", 0.8, 9.5);  // from another thread
    CHECK(t.left(9.5) == Approx(0.5));
    t.update("march", 0.01, 10);
    CHECK(t.elapsed(12) == Approx(2));
    CHECK_FALSE(t.left(12));
    t.end();
    CHECK(t.elapsed(20) == 0);
    t.update("march", 0.5, 30);
    CHECK(t.elapsed(31) == Approx(1));
}

TEST_CASE("durations are printed in the unit that fits") {
    CHECK(TimeLeft::duration(0.2) == "1 s");
    CHECK(TimeLeft::duration(99) == "99 s");
    CHECK(TimeLeft::duration(150) == "3 min");
    CHECK(TimeLeft::duration(5400) == "90 min");
    CHECK(TimeLeft::duration(7260) == "2 h 1 min");
}
