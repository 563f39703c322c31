#include "ImageSpacing.h"

#include "midsurface.h"

#include <algorithm>
#include <sstream>

//------------------------------------------------------------------------------
ImageSpacing::ImageSpacing(const int wholeExtent[6], const double spacing[3])
{
  for (int axis = 0; axis < 3; ++axis)
  {
    const int voxels = wholeExtent[2 * axis + 1] - wholeExtent[2 * axis] + 1;
    this->Dimensions[axis] = static_cast<size_t>(std::max(voxels, 0));
  }
  std::copy_n(spacing, 3, this->Given);
  std::copy_n(spacing, 3, this->Meant);
  this->Stretched = midsurface_unstretched_spacing(this->Dimensions, this->Given, this->Meant);
}

//------------------------------------------------------------------------------
std::string ImageSpacing::Explain(double zOrigin) const
{
  const double scale = this->Meant[2] / this->Given[2];
  std::ostringstream text;
  text
    << "The spacing along z, " << this->Given[2] << ", is the number of slices, "
    << this->Dimensions[2] << ", times the spacing along x, " << this->Given[0]
    << ": the header of the MRC file lacks the number of slices (mz is 1). The result is made as "
       "if the spacing along z were "
    << this->Meant[2]
    << ", but the image itself is still drawn stretched. To draw it as it should be, set Scale, "
       "under Transforming in its display properties, to 1 1 "
    << scale;
  if (zOrigin != 0)
  {
    text << " and Translation to 0 0 " << zOrigin * (1 - scale);
  }
  text << ", or correct the pixel spacing in the file. If the spacing is right, set Spacing to As "
          "given.";
  return text.str();
}
