--- f with the params of a system behind its last argument, as L, constraints and forces take them.
return function(f, params)
  if not f or params == nil then return f end
  return function(...)
    local given = table.pack(...)
    given[given.n + 1] = params
    return f(table.unpack(given, 1, given.n + 1))
  end
end
