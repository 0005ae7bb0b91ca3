return {stability=function() end, doc="problem:stability stub\n x"}
