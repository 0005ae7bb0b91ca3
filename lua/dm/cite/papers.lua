--- The literature: a BibTeX entry each, kind first. Fields in the order in which they are printed.
local FIELDS = { "author", "title", "booktitle", "journal", "volume", "number", "pages",
  "publisher", "school", "type", "edition", "version", "year", "doi", "eprint", "url" }

local rows = {
  dmlua = { "software", author = "{The dmlua developers}", version = "0.1", year = 2026,
    title = "dmlua: an interpreter for discrete mechanics" },
  ["leok-2004"] = { "phdthesis", author = "Leok, Melvin", year = 2004,
    title = "Foundations of Computational Geometric Mechanics",
    school = "California Institute of Technology" },
  ["cuell-patrick-2009"] = { "article", author = "Cuell, Charles and Patrick, George W.",
    title = "Geometric discrete analogues of tangent bundles and constrained {L}agrangian systems",
    journal = "Journal of Geometry and Physics", volume = 59, number = 7, pages = "976--997",
    year = 2009 },
  ["bogfjellmo-2011"] = { "mastersthesis", author = "Bogfjellmo, Geir", year = 2011,
    title = "Discrete Invariant Variational Problems",
    school = "Norwegian University of Science and Technology" },
  ["jalnapurkar-2006"] = { "article", year = 2006,
    author = "Jalnapurkar, Sameer M. and Leok, Melvin and Marsden, Jerrold E. and West, Matthew",
    title = "Discrete {R}outh reduction",
    journal = "Journal of Physics A: Mathematical and General",
    volume = 39, number = 19, pages = "5521--5544" },
  ["marsden-scheurle-1993"] = { "article", author = "Marsden, Jerrold E. and Scheurle, "
      .. "J{\\\"u}rgen",
    title = "{L}agrangian reduction and the double spherical pendulum", year = 1993,
    journal = "Zeitschrift f{\\\"u}r angewandte Mathematik und Physik", volume = 44,
    pages = "17--43" },
  ["leok-marsden-weinstein-2005"] = { "misc", year = 2005,
    author = "Leok, Melvin and Marsden, Jerrold E. and Weinstein, Alan",
    title = "A discrete theory of connections on principal bundles", eprint = "math/0508338" },
  ["desbrun-2005"] = { "misc", year = 2005, title = "Discrete exterior calculus",
    author = "Desbrun, Mathieu and Hirani, Anil N. and Leok, Melvin and Marsden, Jerrold E.",
    eprint = "math/0508341" },
  ["hirani-2003"] = { "phdthesis", author = "Hirani, Anil N.", year = 2003,
    title = "Discrete Exterior Calculus", school = "California Institute of Technology" },
  ["hlw-2006"] = { "book", author = "Hairer, Ernst and Lubich, Christian and Wanner, Gerhard",
    title = "Geometric Numerical Integration", publisher = "Springer", edition = "2nd",
    year = 2006 },
  ["hnw-1993"] = { "book", author = "Hairer, Ernst and N{\\o}rsett, Syvert P. and Wanner, Gerhard",
    title = "Solving Ordinary Differential Equations {I}: Nonstiff Problems",
    publisher = "Springer", edition = "2nd", year = 1993 },
  ["marsden-west-2001"] = { "article", author = "Marsden, Jerrold E. and West, Matthew",
    title = "Discrete mechanics and variational integrators", journal = "Acta Numerica",
    volume = 10, pages = "357--514", year = 2001 },
  ["verlet-1967"] = { "article", author = "Verlet, Loup", year = 1967,
    title = "Computer ``experiments'' on classical fluids. {I}. Thermodynamical properties of "
      .. "{L}ennard-{J}ones molecules",
    journal = "Physical Review", volume = 159, pages = "98--103" },
  ["yoshida-1990"] = { "article", author = "Yoshida, Haruo", year = 1990,
    title = "Construction of higher order symplectic integrators", journal = "Physics Letters A",
    volume = 150, pages = "262--268" },
  ["suzuki-1990"] = { "article", author = "Suzuki, Masuo", year = 1990,
    title = "Fractal decomposition of exponential operators with applications to many-body "
      .. "theories "
      .. "and {M}onte {C}arlo simulations",
    journal = "Physics Letters A", volume = 146, pages = "319--323" },
  ["mclachlan-1995"] = { "article", author = "McLachlan, Robert I.", year = 1995,
    title = "On the numerical integration of ordinary differential equations by symmetric "
      .. "composition methods",
    journal = "SIAM Journal on Scientific Computing", volume = 16, pages = "151--168" },
  ["kahan-li-1997"] = { "article", author = "Kahan, William and Li, Ren-Cang", year = 1997,
    title = "Composition constants for raising the orders of unconventional schemes for ordinary "
      .. "differential equations",
    journal = "Mathematics of Computation", volume = 66, pages = "1089--1099" },
  ["suzuki-umeno-1993"] = { "incollection", author = "Suzuki, Masuo and Umeno, Ken", year = 1993,
    title = "Higher-order decomposition theory of exponential operators and its applications to "
      .. "{QMC} and nonlinear dynamics",
    booktitle = "Computer Simulation Studies in Condensed-Matter Physics {VI}",
    publisher = "Springer", pages = "74--86" },
  ["sofroniou-spaletta-2005"] = { "article", author = "Sofroniou, Mark and Spaletta, Giulia",
    title = "Derivation of symmetric composition constants for symmetric integrators", year = 2005,
    journal = "Optimization Methods and Software", volume = 20, pages = "597--613" },
  ["blanes-moan-2002"] = { "article", author = "Blanes, Sergio and Moan, Per Christian",
    title = "Practical symplectic partitioned {R}unge-{K}utta and {R}unge-{K}utta-{N}ystr{\\\"o}m "
      .. "methods",
    journal = "Journal of Computational and Applied Mathematics", volume = 142, pages = "313--330",
    year = 2002 },
  ["mikkola-tanikawa-1999"] = { "article", author = "Mikkola, Seppo and Tanikawa, Kiyotaka",
    title = "Explicit symplectic algorithms for time-transformed {H}amiltonians", year = 1999,
    journal = "Celestial Mechanics and Dynamical Astronomy", volume = 74, pages = "287--295" },
  ["preto-tremaine-1999"] = { "article", author = "Preto, Miguel and Tremaine, Scott",
    title = "A class of symplectic integrators with adaptive time step for separable "
      .. "{H}amiltonian systems",
    journal = "The Astronomical Journal", volume = 118, pages = "2532--2541", year = 1999 },
  ["kane-marsden-ortiz-1999"] = { "article", year = 1999,
    author = "Kane, Couro and Marsden, Jerrold E. and Ortiz, Michael",
    title = "Symplectic-energy-momentum preserving variational integrators",
    journal = "Journal of Mathematical Physics", volume = 40, pages = "3353--3371" },
  ["bou-rabee-marsden-2009"] = { "article", author = "Bou-Rabee, Nawaf and Marsden, Jerrold E.",
    title = "{H}amilton-{P}ontryagin integrators on {L}ie groups part {I}: introduction and "
      .. "structure-preserving properties",
    journal = "Foundations of Computational Mathematics", volume = 9, pages = "197--219",
    year = 2009 },
  ["munthe-kaas-1999"] = { "article", author = "Munthe-Kaas, Hans", year = 1999,
    title = "High order {R}unge-{K}utta methods on manifolds",
    journal = "Applied Numerical Mathematics", volume = 29, pages = "115--127" },
  ["crouch-grossman-1993"] = { "article", author = "Crouch, Peter E. and Grossman, Robert",
    title = "Numerical integration of ordinary differential equations on manifolds", year = 1993,
    journal = "Journal of Nonlinear Science", volume = 3, pages = "1--33" },
  ["mclachlan-1993"] = { "article", author = "McLachlan, Robert I.", year = 1993,
    title = "Explicit {L}ie-{P}oisson integration and the {E}uler equations",
    journal = "Physical Review Letters", volume = 71, pages = "3043--3046" },
  ["reich-1994"] = { "article", author = "Reich, Sebastian", year = 1994,
    title = "Momentum conserving symplectic integrators", journal = "Physica D", volume = 76,
    pages = "375--383" },
  ["andersen-1983"] = { "article", author = "Andersen, Hans C.", year = 1983,
    title = "Rattle: a ``velocity'' version of the {S}hake algorithm for molecular dynamics "
      .. "calculations",
    journal = "Journal of Computational Physics", volume = 52, pages = "24--34" },
  ["ryckaert-1977"] = { "article", year = 1977,
    author = "Ryckaert, Jean-Paul and Ciccotti, Giovanni and Berendsen, Herman J. C.",
    title = "Numerical integration of the {C}artesian equations of motion of a system with "
      .. "constraints: molecular dynamics of n-alkanes",
    journal = "Journal of Computational Physics", volume = 23, pages = "327--341" },
  ["rowley-marsden-2002"] = { "inproceedings", year = 2002,
    author = "Rowley, Clarence W. and Marsden, Jerrold E.",
    title = "Variational integrators for degenerate {L}agrangians, with application to point "
      .. "vortices",
    booktitle = "Proceedings of the 41st IEEE Conference on Decision and Control",
    pages = "1521--1527" },
  ["fehlberg-1969"] = { "techreport", author = "Fehlberg, Erwin", year = 1969,
    title = "Low-order classical {R}unge-{K}utta formulas with stepsize control and their "
      .. "application to some heat transfer problems",
    type = "NASA Technical Report R-315" },
  ["prince-dormand-1981"] = { "article", author = "Prince, P. J. and Dormand, J. R.", year = 1981,
    title = "High order embedded {R}unge-{K}utta formulae",
    journal = "Journal of Computational and Applied Mathematics", volume = 7, pages = "67--75" },
  ["fels-olver-1999"] = { "article", author = "Fels, Mark and Olver, Peter J.", year = 1999,
    title = "Moving coframes: {II}. Regularization and theoretical foundations",
    journal = "Acta Applicandae Mathematicae", volume = 55, pages = "127--208" },
  ["kogan-olver-2003"] = { "article", author = "Kogan, Irina A. and Olver, Peter J.", year = 2003,
    title = "Invariant {E}uler-{L}agrange equations and the invariant variational bicomplex",
    journal = "Acta Applicandae Mathematicae", volume = 76, pages = "137--193" },
  ["lew-2003"] = { "article", year = 2003,
    author = "Lew, Adrian and Marsden, Jerrold E. and Ortiz, Michael and West, Matthew",
    title = "Asynchronous variational integrators",
    journal = "Archive for Rational Mechanics and Analysis", volume = 167, pages = "85--146" },
  ["marsden-patrick-shkoller-1998"] = { "article", year = 1998,
    author = "Marsden, Jerrold E. and Patrick, George W. and Shkoller, Steve",
    title = "Multisymplectic geometry, variational integrators, and nonlinear {PDE}s",
    journal = "Communications in Mathematical Physics", volume = 199, pages = "351--395" },
  ["bridges-reich-2001"] = { "article", author = "Bridges, Thomas J. and Reich, Sebastian",
    title = "Multi-symplectic integrators: numerical schemes for {H}amiltonian {PDE}s that "
      .. "conserve "
      .. "symplecticity",
    journal = "Physics Letters A", volume = 284, pages = "184--193", year = 2001 },
  ["strang-1968"] = { "article", author = "Strang, Gilbert", year = 1968,
    title = "On the construction and comparison of difference schemes",
    journal = "SIAM Journal on Numerical Analysis", volume = 5, pages = "506--517" },
  ["benettin-1980"] = { "article", year = 1980,
    author = "Benettin, Giancarlo and Galgani, Luigi and Giorgilli, Antonio and Strelcyn, "
      .. "Jean-Marie",
    title = "{L}yapunov characteristic exponents for smooth dynamical systems and for "
      .. "{H}amiltonian systems; a method for computing all of them",
    journal = "Meccanica", volume = 15, pages = "9--20" },
  ["cincotta-simo-2000"] = { "article", author = "Cincotta, Pablo M. and Sim{\\'o}, Carles",
    title = "Simple tools to study global dynamics in non-axisymmetric galactic potentials -- {I}",
    journal = "Astronomy and Astrophysics Supplement Series", volume = 147, pages = "205--228",
    year = 2000 },
  ["gsl"] = { "book", author = "Galassi, Mark and others", year = 2009, edition = "3rd",
    title = "{GNU} Scientific Library Reference Manual", publisher = "Network Theory Ltd." },
}

local M = { keys = {} }
for key in pairs(rows) do M.keys[#M.keys + 1] = key end
table.sort(M.keys)

--- The entry of a key as BibTeX.
function M.bibtex(key)
  local row = rows[key]
  local lines = { ("@%s{%s"):format(row[1], key) }
  for _, field in ipairs(FIELDS) do
    if row[field] then
      lines[#lines + 1] = ("  %s = {%s}"):format(field, tostring(row[field]))
    end
  end
  return table.concat(lines, ",\n") .. "\n}"
end

return M
