/// The local solve of scheme `jet`: no grid, no states, no surface.
///
/// In the chart of a node it looks for the jet (value and gradient) at the origin that continues
/// its neighbors' jets: a fit of each front that they belong to (jet_fit.h), and a fallback where
/// the fit is in doubt (fermat_update.h). docs/method.md, "3. Local solve", has
/// the thresholds.
#pragma once

#include <igeo/march/detail/jet_fit.h>

#include <array>

namespace igeo {

class FermatGroup;

/// Up to eight nodes that are solved side by side, each with the neighbors that have a jet. A node
/// gets the same bits in any group.
class JetGroup {
public:
    /// Takes the nodes out.
    /// @param pull  JetLanes::pull
    void clear(float pull = 0.005f) { size_ = 0, lanes_.pull = pull, filled_ = fitted_ = false; }
    bool full() const { return size_ == Lanes::kNodes; }
    std::size_t size() const { return size_; }

    /// Begins a node.
    /// @param base   values of its neighbors count from here, as the distance to the source does
    /// @param longest2  squared length up to which fermatUpdate takes segments
    void begin(float base, float longest2 = JetNeighbors::kLongest2) {
        nodes_[size_] = {true, true, false, longest2};
        lanes_.base[size_] = base;
        lanes_.count[size_++] = 0;
    }
    /// Adds a neighbor to the node begun last; those beyond JetLanes::kMax are left out.
    /// @param u      relative to the base
    /// @param source whose front it is
    void add(Vec2f a, Vec2f g, float u, std::uint32_t source, bool overCrease) {
        const std::size_t lane = size_ - 1, k = lanes_.count[lane];
        if (k == JetLanes::kMax) return;
        JetLanes::Neighbor& n = lanes_.neighbor[k];
        n.ax[lane] = a.x, n.ay[lane] = a.y, n.gx[lane] = g.x, n.gy[lane] = g.y, n.u[lane] = u;
        sources_[lane][k] = source;
        Node& node = nodes_[lane];
        node.oneSource &= source == sources_[lane][0];
        node.smooth &= !overCrease;
        lanes_.count[lane] = std::uint32_t(k + 1);
    }
    std::size_t count() const { return lanes_.count[size_ - 1]; }  ///< of the node begun last

    /// In place of add(): the node begun last will have so many neighbors, of source 0.
    void expect(std::size_t count, bool smooth) {
        const std::size_t lane = size_ - 1;
        lanes_.count[lane] = std::uint32_t(std::min(count, JetLanes::kMax));
        sources_[lane][0] = 0;
        nodes_[lane].smooth = smooth;
    }
    /// Where they have other sources: that of neighbor k, from the first one on.
    void setSource(std::size_t k, std::uint32_t source) {
        const std::size_t lane = size_ - 1;
        if (k >= lanes_.count[lane]) return;
        sources_[lane][k] = source;
        nodes_[lane].oneSource &= source == sources_[lane][0];
    }
    /// Calls layOut(lanes), which lays out and pads all neighbors that are expected.
    template <typename LayOut>
    void fill(const LayOut& layOut) {
        closeLanes();
        layOut(lanes_);
        filled_ = true;
    }

    /// The jet of a node by one of its fronts.
    struct Solution {
        float u = float(kInfinity);  ///< relative to the base; +inf without neighbors
        Vec2f g;
        std::uint32_t source = 0;
        bool usedFallback = false;
        bool frontsMeet = false;  ///< FrontsMeet::meet
        bool oneSided = false;    ///< by a fit to neighbors that lie on one side of the ray
        float detour = 0;         ///< of a fallback: FermatGroup::detour
        std::array<std::uint8_t, 2> ends{};  ///< of a fallback: FermatGroup::ends
    };
    /// The jets of all nodes. Per node the least of the fits of its fronts; where a fit is in doubt
    /// the fallback is computed as well, and the fit counts if it is valid and the two agree within
    /// 0.01. Fronts of different sources are never fitted together: the lesser value counts, and
    /// the earlier source where they are equal.
    using Solutions = std::array<Solution, Lanes::kNodes>;
    Solutions solve();
    /// The same for one node at a rim, which a front may reach by a last neighbor only, as it goes
    /// around: an obstacle, the end of S, or a corner at which creases meet. A fit to neighbors on
    /// one side of the ray would go straight on into the shadow, so the fallback counts instead.
    Solution solveAtRim(std::size_t lane);
    /// The same for one node, with segments of the fallback up to a longer squared length.
    Solution solveOverSegments(std::size_t lane, float longest2);
    /// The same for one node beside folds, whose normals do not show all creases: a fit counts only
    /// where the fallback agrees.
    Solution solveAtFold(std::size_t lane);

private:
    struct Node {
        bool smooth, oneSource, rim;
        float longest2;
    };
    /// The fronts of the nodes, and the fits of one or two of them.
    struct Fits {
        JetFronts fronts;
        JetFits first, second;
        JetVerdicts verdicts;

        void find(const JetLanes& lanes);
        bool hasSecond(std::size_t k) const { return verdicts.second >> k & 1; }
        bool isClear(std::size_t k) const { return verdicts.clear >> k & 1; }
    };
    struct BestFit;
    Solution solveAgain(std::size_t lane);
    /// Finds the fits of all nodes.
    void fit();
    /// @param doubts  bits: the nodes to solve
    void solveDoubtful(unsigned doubts, Solutions& solutions) const;
    /// What the fits of a node come to.
    BestFit bestFit(std::size_t lane) const;
    using BestFits = std::array<BestFit, Lanes::kNodes>;
    /// The fits of nodes, or their fallbacks.
    /// @param nodes  bits
    void decide(unsigned nodes, const BestFits& fits, const FermatGroup& fallback,
                Solutions& solutions) const;
    Solution solvePerSource(std::size_t lane) const;
    void closeLanes() {
        for (std::size_t k = size_; k < Lanes::kNodes; ++k) lanes_.count[k] = 0, lanes_.base[k] = 0;
    }

    std::size_t size_ = 0;
    bool filled_ = false, fitted_ = false;
    std::array<Node, Lanes::kNodes> nodes_;
    std::array<std::array<std::uint32_t, JetLanes::kMax>, Lanes::kNodes> sources_;
    JetLanes lanes_;
    Fits fits_;
};

/// The jet at the origin from the neighbors of one source, by itself.
Jet jetUpdate(const JetNeighbors& all);

}  // namespace igeo
