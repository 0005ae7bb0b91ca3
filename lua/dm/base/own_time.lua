--- Does a rule have a time of its own: is what a step covers of it known only when it is taken?
-- Runs of it end at given times (at=), not after so many steps, and what lies beside a run, such as
-- a tangent vector, has other times than the run.
return function(rule)
  rule = tostring(rule)
  return rule:find "^log%-hamiltonian" ~= nil or rule:find "^sem%s*%(" ~= nil
end
