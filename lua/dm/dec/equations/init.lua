--- Operators of a mesh as sparse matrices, their eigenforms, and the equations that they make.
local matrices = require "dm.dec.equations.matrices"
require "dm.dec.equations.eigen"
require "dm.dec.equations.hodge"
require "dm.dec.equations.poisson"
require "dm.dec.equations.darcy"

return matrices
