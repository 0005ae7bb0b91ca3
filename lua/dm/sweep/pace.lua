--- Lengths of ranges: the first ones are short, since nobody knows how long members take.

--- pace(unit, goal) -> size: size() members, a multiple of `unit`, should take `goal` seconds;
-- size(took) tells how long so many took.
return function(unit, goal)
  local size = unit
  return function(took)
    if took then
      local by = math.max(0.25, math.min(4, goal / math.max(took, 1e-6)))
      size = math.max(unit, math.floor(size * by) // unit * unit)
    end
    return size
  end
end
