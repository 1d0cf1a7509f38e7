#include <vtkCellArray.h>
#include <vtkDijkstraGraphGeodesicPath.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include "peer.h"

namespace igeo::test {
namespace {

class Dijkstra : public Peer {
public:
    explicit Dijkstra(const TriangleMesh& mesh) {
        vtkNew<vtkPoints> points;
        points->SetDataTypeToDouble();
        for (const Vec3d& p : mesh.points) points->InsertNextPoint(p.x, p.y, p.z);
        vtkNew<vtkCellArray> cells;
        for (const auto& t : mesh.triangles) {
            const vtkIdType corners[]{t[0], t[1], t[2]};
            cells->InsertNextCell(3, corners);
        }
        mesh_->SetPoints(points);
        mesh_->SetPolys(cells);
        path_->SetInputData(mesh_);
        path_->StopWhenEndReachedOff();
    }

    std::vector<double> distances(std::size_t seed) override {
        // It wants an end as well, and then goes on.
        path_->SetStartVertex(vtkIdType(seed));
        path_->SetEndVertex(seed == 0 ? 1 : 0);
        path_->Update();
        vtkNew<vtkDoubleArray> weights;
        path_->GetCumulativeWeights(weights);
        std::vector<double> result;
        for (vtkIdType k = 0; k < weights->GetNumberOfTuples(); ++k)
            result.push_back(weights->GetValue(k));
        return result;
    }

private:
    vtkNew<vtkPolyData> mesh_;
    vtkNew<vtkDijkstraGraphGeodesicPath> path_;
};

}  // namespace

std::unique_ptr<Peer> dijkstraOnEdges(const TriangleMesh& mesh) {
    return std::make_unique<Dijkstra>(mesh);
}

}  // namespace igeo::test
