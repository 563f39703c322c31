#include "Pieces.h"

#include "BlockRun.h"
#include "SegmentationVolume.h"

#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkMatrix3x3.h"
#include "vtkMultiProcessController.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{
using Pipeline = vtkStreamingDemandDrivenPipeline;
constexpr int first = 0;

vtkMultiProcessController* Controller()
{
  return vtkMultiProcessController::GetGlobalController();
}

/** What the processes tell each other about their piece; numbers only, to be sent as they are. */
struct Header
{
  double Extent[6];
  /** What the source says that all pieces together are. */
  double Whole[6];
  double Spacing[3];
  double Origin[3];
  double Direction[9];
  double Association;
  /** VTK_VOID where the piece is empty. */
  double DataType;

  bool IsEmpty() const { return this->DataType == VTK_VOID; }
  bool OnCells() const { return this->Association == vtkDataObject::FIELD_ASSOCIATION_CELLS; }
  bool FitsTo(const Header& other) const
  {
    return this->Association == other.Association && this->DataType == other.DataType &&
      std::equal(this->Whole, this->Whole + 6, other.Whole);
  }
};
constexpr vtkIdType headerLength = sizeof(Header) / sizeof(double);

Header Describe(vtkInformation* source, vtkImageData* piece, const ChosenArray& chosen)
{
  Header header{};
  const bool isTold = source->Has(Pipeline::WHOLE_EXTENT());
  std::copy_n(isTold ? source->Get(Pipeline::WHOLE_EXTENT()) : piece->GetExtent(), 6, header.Whole);
  vtkDataArray* labels = chosen.Labels();
  header.Association = chosen.Association;
  header.DataType = labels && labels->GetNumberOfTuples() > 0 ? labels->GetDataType() : VTK_VOID;
  std::copy_n(piece->GetExtent(), 6, header.Extent);
  std::copy_n(piece->GetSpacing(), 3, header.Spacing);
  std::copy_n(piece->GetOrigin(), 3, header.Origin);
  std::copy_n(piece->GetDirectionMatrix()->GetData(), 9, header.Direction);
  return header;
}

std::vector<Header> GatherHeaders(const Header& own)
{
  std::vector<Header> headers(static_cast<size_t>(Controller()->GetNumberOfProcesses()));
  Controller()->AllGather(
    reinterpret_cast<const double*>(&own), reinterpret_cast<double*>(headers.data()), headerLength);
  headers.erase(std::remove_if(headers.begin(), headers.end(),
                  [](const Header& header) { return header.IsEmpty(); }),
    headers.end());
  return headers;
}

/** The extent in which the array's values are counted: cells lie between points. */
void ValueExtent(const Header& header, const int points[6], int values[6])
{
  std::copy_n(points, 6, values);
  for (int axis = 0; header.OnCells() && axis < 3; ++axis)
  {
    values[2 * axis + 1] = std::max(points[2 * axis], points[2 * axis + 1] - 1);
  }
}

vtkIdType Size(const int extent[6])
{
  return vtkIdType(extent[1] - extent[0] + 1) * (extent[3] - extent[2] + 1) *
    (extent[5] - extent[4] + 1);
}

/** Whether the pieces lie in `whole` and are, taken together, as many cells. */
bool FillWhole(const std::vector<Header>& headers, const int whole[6])
{
  Header cells = headers.front();
  cells.Association = vtkDataObject::FIELD_ASSOCIATION_CELLS;
  vtkIdType count = 0;
  int extent[6];
  for (const Header& header : headers)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      if (header.Extent[2 * axis] < whole[2 * axis] ||
        header.Extent[2 * axis + 1] > whole[2 * axis + 1])
      {
        return false;
      }
    }
    int points[6];
    std::copy_n(header.Extent, 6, points);
    ValueExtent(cells, points, extent);
    count += Size(extent);
  }
  ValueExtent(cells, whole, extent);
  return count >= Size(extent);
}

void CheckFit(const std::vector<Header>& headers, const int whole[6])
{
  const auto fits = [&headers](const Header& header) { return header.FitsTo(headers.front()); };
  if (!std::all_of(headers.begin(), headers.end(), fits) || !FillWhole(headers, whole))
  {
    throw std::runtime_error(
      "The segmentation is spread over several processes, whose parts do not "
      "make up one image: save it to a file and open that.");
  }
}

vtkSmartPointer<vtkImageData> MakeImage(const Header& header, const int whole[6])
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetExtent(const_cast<int*>(whole));
  image->SetSpacing(header.Spacing);
  image->SetOrigin(header.Origin);
  image->SetDirectionMatrix(header.Direction);
  return image;
}
} // namespace

//------------------------------------------------------------------------------
bool Pieces::AreMany(vtkInformation* output)
{
  return output->Get(Pipeline::UPDATE_NUMBER_OF_PIECES()) > 1;
}

//------------------------------------------------------------------------------
bool Pieces::AreShared(vtkInformation* output)
{
  return Pieces::AreMany(output) && Controller() &&
    Controller()->GetNumberOfProcesses() == output->Get(Pipeline::UPDATE_NUMBER_OF_PIECES());
}

//------------------------------------------------------------------------------
bool Pieces::IsFirst(vtkInformation* output)
{
  return output->Get(Pipeline::UPDATE_PIECE_NUMBER()) <= first;
}

//------------------------------------------------------------------------------
int Pieces::Result(vtkInformation* output, int result)
{
  return Pieces::AreMany(output) ? 1 : result;
}

//------------------------------------------------------------------------------
bool Pieces::HasToWork(const BlockRun& run, vtkInformation* output)
{
  return run.HasBlocks() || Pieces::IsFirst(output);
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkImageData> Pieces::Frame(
  vtkInformation* source, vtkImageData* piece, const ChosenArray& chosen, int& association)
{
  const std::vector<Header> headers = GatherHeaders(Describe(source, piece, chosen));
  if (headers.empty())
  {
    return nullptr;
  }
  int whole[6];
  std::copy_n(headers.front().Whole, 6, whole);
  CheckFit(headers, whole);
  association = static_cast<int>(headers.front().Association);
  return MakeImage(headers.front(), whole);
}
